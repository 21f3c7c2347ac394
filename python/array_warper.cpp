/// @file array_warper.cpp
/// Steps on arrays of Python: checks of memory, calls without the interpreter's lock, steps in
/// flight.
#include "python/array_warper.hpp"

#include <cstddef>
#include <stdexcept>
#include <tetwarp/error.hpp>

#include "python/interpreter_lock.hpp"
#include "python/interruption.hpp"
#include "python/overlap.hpp"

namespace tetwarp::python {
namespace {
/// An array of `arrays`, null if there is none of this name.
template <class T>
T* data_of(const nb::dict& arrays, const char* name) {
  if (!arrays.contains(name)) return nullptr;
  return nb::cast<nb::ndarray<T, nb::c_contig>>(arrays[name], false).data();
}
}  // namespace

WarpTarget StepArrays::target(std::vector<void*>& samples) const {
  for (const AnyOut& volume : volumes) samples.push_back(volume.data());
  WarpTarget target{.volumes = samples};
  target.memory = memory_of(volumes.front());
  target.mask = data_of<std::uint8_t>(extras, "mask");
  target.owner = data_of<std::int32_t>(extras, "owner");
  target.fields = {.displacement = data_of<float>(extras, "displacement"),
                   .jacobian = data_of<float>(extras, "jacobian"),
                   .gradient = data_of<float>(extras, "gradient"),
                   .strain = data_of<float>(extras, "strain"),
                   .forward = data_of<float>(extras, "forward")};
  target.stream = reinterpret_cast<void*>(stream);
  return target;
}

PositionsView StepArrays::positions() const {
  return {deformed.data(), static_cast<std::int64_t>(deformed.shape(0)), memory_of(deformed)};
}

ArrayWarper::ArrayWarper(std::vector<AnySamples> sources,
                         const Grid& grid,
                         const CurvedMesh& mesh,
                         const WarpOptions& options)
    : sources_(std::move(sources)), warper_(make_warper(grid, mesh, options)) {}

Warper ArrayWarper::make_warper(const Grid& grid,
                                const CurvedMesh& mesh,
                                const WarpOptions& options) const {
  std::vector<VolumeView> views;
  for (const AnySamples& samples : sources_) views.push_back(view_of(samples, grid));
  const LockReleased release;
  return {views, mesh, options};
}

void ArrayWarper::check_arrays(const StepArrays& arrays) const {
  const std::vector<AnyOut>& volumes = arrays.volumes;
  check_outputs(volumes, sources_);
  for (std::size_t n = 0; n < volumes.size(); ++n) {
    if (overlap(arrays.deformed, volumes[n])) {
      throw std::invalid_argument(out_name(volumes, n) + ": shares memory with deformed");
    }
    for (const Flight& flight : flights_) {
      if (overlaps_any(volumes[n], flight.arrays.volumes)) {
        throw std::invalid_argument(out_name(volumes, n) +
                                    ": shares memory with an output of a step in flight");
      }
      const AnyPoints& read = flight.arrays.deformed;
      if (memory_of(read) == Memory::device && overlap(read, volumes[n])) {
        throw std::invalid_argument(out_name(volumes, n) +
                                    ": shares memory with deformed of a step in flight");
      }
    }
  }
  for (const Flight& flight : flights_) {
    if (overlaps_any(arrays.deformed, flight.arrays.volumes)) {
      throw std::invalid_argument("deformed: shares memory with an output of a step in flight");
    }
  }
}

StepReport ArrayWarper::step(const StepArrays& arrays, nb::object progress) {
  const OneCall call(is_running_, "Warper");
  if (!flights_.empty()) {
    throw std::runtime_error("Warper: a step is in flight; finish it first");
  }
  check_arrays(arrays);
  std::vector<void*> samples;
  const WarpTarget target = arrays.target(samples);
  Interruption interruption(std::move(progress));
  return interruption.run([&] {
    return warper_.step(arrays.positions(), target,
                        [&](double fraction) { return interruption.go_on(fraction); });
  });
}

void ArrayWarper::begin_step(StepArrays arrays, nb::object given, nb::object progress) {
  const OneCall call(is_running_, "Warper");
  if (flights_.size() == Warper::max_steps_in_flight) {
    throw std::runtime_error("Warper: two steps are in flight; finish one first");
  }
  check_arrays(arrays);
  std::vector<void*> samples;
  const WarpTarget target = arrays.target(samples);
  Interruption interruption(std::move(progress));
  bool goes_on = true;
  interruption.run([&] {
    warper_.begin_step(arrays.positions(), target, [&](double fraction) {
      goes_on = goes_on && interruption.go_on(fraction);
      return goes_on;
    });
  });
  flights_.push_back({std::move(arrays), std::move(given)});
  if (goes_on) return;
  // The library keeps the error for the end of the step, which comes after that of the one before.
  for (Flight& flight : flights_) settle(flight);
  flights_.pop_back();
  interruption.throw_error();
  throw Cancelled();
}

void ArrayWarper::settle(Flight& flight) {
  if (flight.report || flight.error) return;
  const LockReleased release;
  try {
    flight.report = warper_.finish_step();
  } catch (...) {
    flight.error = std::current_exception();
  }
}

std::pair<nb::object, StepReport> ArrayWarper::finish_step() {
  const OneCall call(is_running_, "Warper");
  if (flights_.empty()) throw std::runtime_error("Warper: no step is in flight");
  settle(flights_.front());
  const Flight flight = std::move(flights_.front());
  flights_.pop_front();
  if (flight.error) std::rethrow_exception(flight.error);
  return {flight.given, *flight.report};
}

std::string ArrayWarper::report() {
  const OneCall call(is_running_, "Warper");
  return to_json(warper_.report());
}

}  // namespace tetwarp::python
