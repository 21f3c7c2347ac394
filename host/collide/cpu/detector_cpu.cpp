/// @file detector_cpu.cpp
/// make_cpu_detector(): collision detection on host threads.
#include "host/collide/exec_detector.hpp"
#include "host/exec/exec_cpu.hpp"

namespace tetwarp {

std::unique_ptr<Detector> make_cpu_detector(const CollisionSurfaces& surfaces,
                                            const DetectorOptions& options) {
  return std::make_unique<ExecDetector<CpuExec>>(
      CpuExec(thread_count(options.threads), StageClocks::off), surfaces, options);
}

}  // namespace tetwarp
