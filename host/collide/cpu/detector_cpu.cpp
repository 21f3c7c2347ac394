/// @file detector_cpu.cpp
/// make_cpu_detector(): DetectorPipeline on host threads.
#include "host/collide/cpu/detect_exec_cpu.hpp"
#include "host/collide/detector_pipeline.hpp"

namespace tetwarp {
namespace {
class CpuDetector final : public Detector {
 public:
  CpuDetector(const CollisionSurfaces& surfaces, const DetectorOptions& options)
      : exec_(thread_count(options.threads)), pipeline_(exec_, surfaces, options) {}

  void begin_step() override { pipeline_.begin_step(); }
  void set_still(std::span<const std::uint8_t> is_still) override { pipeline_.set_still(is_still); }
  const std::vector<TouchingPair>& detect(const SurfaceMotion& motion) override {
    return pipeline_.detect(motion);
  }
  const std::vector<TouchingPair>& detect_hits(const SurfaceMotion& motion) override {
    return pipeline_.detect_hits(motion);
  }
  const std::vector<TouchingPair>& check(const SurfaceMotion& motion) override {
    return pipeline_.check(motion);
  }
  std::int64_t find_touches(const SurfaceMotion& motion) override {
    return pipeline_.find_touches(motion);
  }
  const std::vector<std::int32_t>& reached() const override { return pipeline_.reached(); }
  std::span<const ChosenTouch> touches() override { return pipeline_.touches(); }
  using Detector::closest;
  ClosestPair closest(const SurfacePlaces& places,
                      double cap,
                      const MotionView& resident) override {
    return pipeline_.closest(places, cap, resident);
  }
  DetectionCounts counts() override { return pipeline_.take_counts(); }

 private:
  CpuDetectExec exec_;
  DetectorPipeline<CpuDetectExec> pipeline_;
};
}  // namespace

std::unique_ptr<Detector> make_cpu_detector(const CollisionSurfaces& surfaces,
                                            const DetectorOptions& options) {
  return std::make_unique<CpuDetector>(surfaces, options);
}

}  // namespace tetwarp
