/// @file step_queue.cpp
/// Starts steps, waits for those that write to the same memory, and keeps errors for their step.
#include "host/warp/step_queue.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "host/warp/target.hpp"

namespace tetwarp {

StepQueue::StepQueue(std::unique_ptr<WarpBackend> backend) : backend_(std::move(backend)) {}

StepQueue::~StepQueue() {
  if (!flights_.empty()) backend_->drain();
}

bool StepQueue::writes_to(const WarpTarget& target) const {
  return std::ranges::any_of(flights_, [&](const auto& flight) {
    const std::vector<void*> others = arrays_of(flight->target);
    return std::ranges::any_of(arrays_of(target), [&](const void* array) {
      return array != nullptr && std::ranges::find(others, array) != others.end();
    });
  });
}

void StepQueue::begin(const PositionsView& deformed,
                      const WarpTarget& target,
                      const Progress& progress) {
  Flight* const before = flights_.empty() ? nullptr : flights_.back().get();
  const int number = before == nullptr ? 0 : 1 - before->number;
  flights_.push_back(std::make_unique<Flight>(Flight{number,
                                                     {target.volumes.begin(), target.volumes.end()},
                                                     target,
                                                     std::chrono::steady_clock::now()}));
  Flight& now = *flights_.back();
  now.target.volumes = now.volumes;
  attempt(now, [&] { backend_->upload(now.number, deformed); });
  // A step may update the previous one, which must therefore be computed first. Its download may
  // block this thread, so it is queued after the kernels of the new step.
  if (before != nullptr) settle(*before);
  attempt(now, [&] { backend_->compute(now.number, now.target, progress); });
  if (before != nullptr) attempt(*before, [&] { backend_->download(before->number); });
}

StepReport StepQueue::finish() {
  const std::unique_ptr<Flight> flight = std::move(flights_.front());
  flights_.erase(flights_.begin());
  settle(*flight);
  StepReport report;
  attempt(*flight, [&] {
    backend_->download(flight->number);
    report = backend_->finish(flight->number);
  });
  if (flight->error) {
    backend_->drain();
    std::rethrow_exception(flight->error);
  }
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - flight->start;
  report.timings.total = passed.count();
  return report;
}

void StepQueue::attempt(Flight& flight, const std::function<void()>& part) {
  if (flight.error) return;
  try {
    part();
  } catch (...) {
    flight.error = std::current_exception();
  }
}

void StepQueue::settle(Flight& flight) {
  if (std::exchange(flight.is_settled, true)) return;
  attempt(flight, [&] { backend_->settle(flight.number); });
}

}  // namespace tetwarp
