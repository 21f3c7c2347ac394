/// @file exec_detector.hpp
/// ExecDetector: DetectorPipeline on an executor, as a Detector.
#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "host/collide/detector.hpp"
#include "host/collide/detector_pipeline.hpp"

namespace tetwarp {

/// @tparam Exec  CpuExec or CudaExec
template <class Exec>
class ExecDetector final : public Detector {
 public:
  ExecDetector(Exec exec, const CollisionSurfaces& surfaces, const DetectorOptions& options)
      : exec_(std::move(exec)), pipeline_(exec_, surfaces, options) {}

  void begin_step() override { pipeline_.begin_step(); }
  void set_still(std::span<const std::uint8_t> is_still) override {
    [[maybe_unused]] const auto scope = exec_.enter();
    pipeline_.set_still(is_still);
  }
  const std::vector<TouchingPair>& detect(const SurfaceMotion& motion) override {
    [[maybe_unused]] const auto scope = exec_.enter();
    return pipeline_.detect(motion);
  }
  const std::vector<TouchingPair>& detect_hits(const SurfaceMotion& motion) override {
    [[maybe_unused]] const auto scope = exec_.enter();
    return pipeline_.detect_hits(motion);
  }
  const std::vector<TouchingPair>& check(const SurfaceMotion& motion) override {
    [[maybe_unused]] const auto scope = exec_.enter();
    return pipeline_.check(motion);
  }
  std::int64_t find_touches(const SurfaceMotion& motion) override {
    [[maybe_unused]] const auto scope = exec_.enter();
    return pipeline_.find_touches(motion);
  }
  const std::vector<std::int32_t>& reached() const override { return pipeline_.reached(); }
  std::span<const ChosenTouch> touches() override {
    [[maybe_unused]] const auto scope = exec_.enter();
    return pipeline_.touches();
  }
  using Detector::closest;
  ClosestPair closest(const SurfacePlaces& places,
                      double cap,
                      const MotionView& resident) override {
    [[maybe_unused]] const auto scope = exec_.enter();
    return pipeline_.closest(places, cap, resident);
  }
  DetectionCounts counts() override { return pipeline_.take_counts(); }

 private:
  Exec exec_;
  DetectorPipeline<Exec> pipeline_;
};

}  // namespace tetwarp
