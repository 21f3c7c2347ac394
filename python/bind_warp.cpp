/// @file bind_warp.cpp
/// The Warper.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <tetwarp/warp.hpp>
#include <utility>
#include <vector>

#include "host/base/report_fields.hpp"
#include "python/arrays.hpp"
#include "python/bind.hpp"
#include "python/choices.hpp"
#include "python/curved_arrays.hpp"
#include "python/interpreter_lock.hpp"
#include "python/interruption.hpp"

namespace tetwarp::python {
namespace {
/// Whether arrays in C order share memory.
bool overlap(const auto& one, const auto& other) {
  const auto bytes = [](const void* data) { return static_cast<const std::byte*>(data); };
  const std::byte* const first = bytes(one.data());
  const std::byte* const second = bytes(other.data());
  return first < second + other.nbytes() && second < first + one.nbytes();
}

/// A Warper and the arrays of its sources, which it reads in place.
class ArrayWarper {
 public:
  ArrayWarper(std::vector<AnySamples> sources,
              const Grid& grid,
              const CurvedMesh& mesh,
              const WarpOptions& options)
      : sources_(std::move(sources)), warper_(make_warper(grid, mesh, options)) {}

  StepReport step(const PositionsView& deformed, const WarpTarget& target, nb::object progress) {
    const OneCall call(is_running_, "Warper");
    Interruption interruption(std::move(progress));
    return interruption.run([&] {
      return warper_.step(deformed, target,
                          [&](double fraction) { return interruption.go_on(fraction); });
    });
  }

  /// What all steps share, with the records of the steps so far.
  /// @throws std::runtime_error  a step is running, which adds its record
  std::string report() {
    const OneCall call(is_running_, "Warper");
    return to_json(warper_.report());
  }

  /// @pre no step is running
  const Report& shared() const { return warper_.report(); }

  bool shares_memory(const AnyOut& out) const {
    return std::ranges::any_of(sources_,
                               [&](const AnySamples& source) { return overlap(source, out); });
  }

 private:
  Warper make_warper(const Grid& grid, const CurvedMesh& mesh, const WarpOptions& options) const {
    std::vector<VolumeView> views;
    for (const AnySamples& samples : sources_) views.push_back(view_of(samples, grid));
    const LockReleased release;
    return {views, mesh, options};
  }

  std::vector<AnySamples> sources_;
  Warper warper_;
  std::atomic<bool> is_running_ = false;
};

/// An array of `arrays`, null if there is none of this name.
template <class T>
T* data_of(const nb::dict& arrays, const char* name) {
  if (!arrays.contains(name)) return nullptr;
  return nb::cast<nb::ndarray<T, nb::c_contig>>(arrays[name], false).data();
}

/// Arrays that are all in the memory of the first volume.
WarpTarget target_of(const std::vector<void*>& volumes, Memory memory, const nb::dict& extras) {
  WarpTarget target{.volumes = volumes};
  target.memory = memory;
  target.mask = data_of<std::uint8_t>(extras, "mask");
  target.owner = data_of<std::int32_t>(extras, "owner");
  target.fields = {.displacement = data_of<float>(extras, "displacement"),
                   .jacobian = data_of<float>(extras, "jacobian"),
                   .gradient = data_of<float>(extras, "gradient"),
                   .strain = data_of<float>(extras, "strain"),
                   .forward = data_of<float>(extras, "forward")};
  return target;
}

nb::dict dict_of(const Totals& totals) {
  nb::dict all;
  all["before"] = totals.before;
  all["after"] = totals.after;
  all["rounding"] = totals.rounding;
  all["clipping"] = totals.clipping;
  return all;
}

/// What a step did, and the members of the report that all steps share.
struct StepOf {
  StepReport step;
  Backend backend;
  std::string backend_reason, device;
  int threads;
  double position_quantum;
};

nb::dict dict_of(const StepOf& of) {
  nb::dict counts, timings, report;
  for (const auto& field : count_fields) counts[field.name] = of.step.counts.*field.member;
  for (const auto& field : timing_fields) timings[field.name] = of.step.timings.*field.member;
  report["backend"] = name_of(of.backend);
  report["backend_reason"] = of.backend_reason;
  report["device"] = of.device;
  report["threads"] = of.threads;
  report["position_quantum"] = of.position_quantum;
  report["step"] = of.step.step;
  report["counts"] = counts;
  report["timings"] = timings;
  report["totals"] = dict_of(of.step.totals);
  return report;
}

StepOf run_step(ArrayWarper& warper,
                const AnyPoints& deformed,
                const std::vector<AnyOut>& volumes,
                const nb::dict& extras,
                bool holds_previous,
                std::uintptr_t stream,
                nb::object progress) {
  const auto out_name = [&](std::size_t n) {
    return volumes.size() == 1 ? std::string("out") : "out[" + std::to_string(n) + "]";
  };
  std::vector<void*> samples;
  samples.reserve(volumes.size());
  for (std::size_t n = 0; n < volumes.size(); ++n) {
    const std::span earlier = std::span(volumes).first(n);
    if (warper.shares_memory(volumes[n]) ||
        std::ranges::any_of(earlier, [&](const AnyOut& out) { return overlap(out, volumes[n]); })) {
      throw std::invalid_argument(out_name(n) + ": shares memory with a source or another output");
    }
    if (overlap(deformed, volumes[n])) {
      throw std::invalid_argument(out_name(n) + ": shares memory with deformed");
    }
    samples.push_back(volumes[n].data());
  }
  const PositionsView positions(deformed.data(), static_cast<std::int64_t>(deformed.shape(0)),
                                memory_of(deformed));
  WarpTarget target = target_of(samples, memory_of(volumes.front()), extras);
  target.holds_previous = holds_previous;
  target.stream = reinterpret_cast<void*>(stream);
  const StepReport step = warper.step(positions, target, std::move(progress));
  const Report& whole = warper.shared();
  return {step,         whole.backend, whole.backend_reason,
          whole.device, whole.threads, whole.position_quantum};
}

void make_array_warper(ArrayWarper* self,
                       std::vector<AnySamples> sources,
                       const Grid& grid,
                       const InPoints& points,
                       const InTets& tets,
                       const InHexes& hexes,
                       const InMidNodes& mids,
                       const std::string& interpolator,
                       const std::string& label_rule,
                       const std::array<double, 2>& label_gaussian,
                       const std::string& overshoot,
                       bool antialias,
                       const std::string& intensity,
                       const std::vector<std::string>& quantities,
                       const std::string& outside,
                       double falloff,
                       double default_value,
                       std::optional<Grid> output_grid,
                       const std::string& backend,
                       int device,
                       int threads) {
  WarpOptions options{.filter = choice<Filter>("interpolator", interpolator),
                      .label_rule = choice<LabelRule>("label_rule", label_rule),
                      .label_gaussian = {label_gaussian[0], label_gaussian[1]},
                      .overshoot = choice<Overshoot>("overshoot", overshoot),
                      .antialias = antialias,
                      .intensity = choice<Intensity>("intensity", intensity),
                      .outside = choice<Outside>("outside", outside),
                      .falloff = falloff,
                      .background = default_value,
                      .output_grid = output_grid,
                      .backend = choice<Backend>("backend", backend),
                      .device = device,
                      .threads = threads};
  for (const std::string& word : quantities) {
    options.quantities.push_back(choice<Quantity>("quantity", word));
  }
  new (self)
      ArrayWarper(std::move(sources), grid, curved_mesh_of(points, tets, hexes, mids), options);
}
}  // namespace

void bind_warp(nb::module_& module) {
  nb::class_<StepOf>(module, "StepReport").def("dict", [](const StepOf& self) {
    return dict_of(self);
  });
  nb::class_<ArrayWarper>(module, "Warper")
      .def("__init__", &make_array_warper, nb::arg("sources"), nb::arg("grid"), nb::arg("points"),
           nb::arg("tets"), nb::arg("hexes"), nb::arg("mids"), nb::kw_only(),
           nb::arg("interpolator"), nb::arg("label_rule"), nb::arg("label_gaussian"),
           nb::arg("overshoot"), nb::arg("antialias"), nb::arg("intensity"), nb::arg("quantities"),
           nb::arg("outside"), nb::arg("falloff"), nb::arg("default_value"),
           nb::arg("output_grid").none(), nb::arg("backend"), nb::arg("device"), nb::arg("threads"))
      .def("report", &ArrayWarper::report)
      .def("step", &run_step, nb::arg("deformed"), nb::arg("volumes"), nb::arg("extras"),
           nb::arg("holds_previous"), nb::arg("stream"), nb::arg("progress").none());
}

}  // namespace tetwarp::python
