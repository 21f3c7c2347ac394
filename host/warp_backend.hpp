/// @file warp_backend.hpp
/// What Warper asks of a back end, and what it hands over: checked arguments, nothing to check
/// again.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <tetwarp/warp.hpp>

namespace tetwarp {

/// Checked arguments of a Warper and the geometry that no step changes.
struct WarpPlan {
  std::vector<VolumeView> sources;
  TetMesh mesh;
  WarpOptions options;
  Grid output_grid;  ///< the whole output grid
  Region region;     ///< part of it to compute
  Grid target_grid;  ///< grid of the region
};

/// One of cpu, cuda and reference.
class WarpBackend {
 public:
  virtual ~WarpBackend() = default;

  /// As Warper::step(), arguments checked.
  virtual StepReport step(const PositionsView& deformed,
                          const WarpTarget& target,
                          const Progress& progress) = 0;
  /// Device or processor name.
  virtual std::string device() const = 0;
  virtual int threads() const = 0;
};

std::unique_ptr<WarpBackend> make_cpu_backend(const WarpPlan& plan);
std::unique_ptr<WarpBackend> make_cuda_backend(const WarpPlan& plan);
std::unique_ptr<WarpBackend> make_reference_backend(const WarpPlan& plan);

/// Name of CUDA device `device`, or why it does not answer.
BackendStatus cuda_status(int device);

/// The processor's name.
std::string processor_name();

}  // namespace tetwarp
