/// @file detector_cuda.cuh
/// CudaDetector: DetectorPipeline on a device.
#pragma once
#include "host/collide/cuda/detect_exec_cuda.cuh"
#include "host/collide/detector_pipeline.hpp"

namespace tetwarp {

class CudaDetector final : public Detector {
 public:
  CudaDetector(const CollisionSurfaces& surfaces, const DetectorOptions& options)
      : exec_(options.device), pipeline_(exec_, surfaces, options) {}

  void begin_step() override { pipeline_.begin_step(); }
  void set_still(std::span<const std::uint8_t> is_still) override {
    const auto scope = exec_.enter();
    pipeline_.set_still(is_still);
  }
  const std::vector<TouchingPair>& detect(const SurfaceMotion& motion) override {
    const auto scope = exec_.enter();
    return pipeline_.detect(motion);
  }
  const std::vector<TouchingPair>& detect_hits(const SurfaceMotion& motion) override {
    const auto scope = exec_.enter();
    return pipeline_.detect_hits(motion);
  }
  const std::vector<TouchingPair>& check(const SurfaceMotion& motion) override {
    const auto scope = exec_.enter();
    return pipeline_.check(motion);
  }
  std::int64_t find_touches(const SurfaceMotion& motion) override {
    const auto scope = exec_.enter();
    return pipeline_.find_touches(motion);
  }
  const std::vector<std::int32_t>& reached() const override { return pipeline_.reached(); }
  std::span<const ChosenTouch> touches() override {
    const auto scope = exec_.enter();
    return pipeline_.touches();
  }
  using Detector::closest;
  ClosestPair closest(const SurfacePlaces& places,
                      double cap,
                      const MotionView& resident) override {
    const auto scope = exec_.enter();
    return pipeline_.closest(places, cap, resident);
  }
  DetectionCounts counts() override { return pipeline_.take_counts(); }

 private:
  CudaDetectExec exec_;
  DetectorPipeline<CudaDetectExec> pipeline_;
};

}  // namespace tetwarp
