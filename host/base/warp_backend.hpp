/// @file warp_backend.hpp
/// What Warper asks of a back end, and what it hands over: checked arguments, nothing to check
/// again.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <tetwarp/warp.hpp>

namespace tetwarp {

/// Checked arguments of a Warper and the geometry that no step changes.
struct WarpPlan {
  std::vector<VolumeView> sources;
  Mesh mesh;  ///< of its tetrahedra the last are those that its hexahedra split into
  WarpOptions options;
  Region source_region;  ///< of the source grid: voxels that the sources' data hold
  Grid output_grid;      ///< the whole output grid
  Region region;         ///< part of it to compute
  Grid target_grid;      ///< grid of the region
};

/// One of cpu, cuda and reference. A step has five parts, called in this order and each once; a
/// part that throws ends its step. Two steps, numbers 0 and 1, may be in flight: of the later one
/// only upload() comes before settle(), and only compute() before deliver() and finish() of the
/// earlier.
class WarpBackend {
 public:
  virtual ~WarpBackend() = default;

  /// Takes the positions: host memory may change afterwards.
  virtual void upload(int flight, const PositionsView& deformed) = 0;
  /// Has the step computed, or at least asked for. The target stays as it is until finish().
  virtual void compute(int flight, const WarpTarget& target, const Progress& progress) = 0;
  /// Waits until it is computed; what is wrong with it is known then.
  virtual void settle(int) {}
  /// Asks for the result to be brought to the target.
  virtual void deliver(int) {}
  /// Waits until it is there. The report lacks the total time.
  virtual StepReport finish(int flight) = 0;
  /// Waits until nothing is under way.
  virtual void drain() noexcept {}

  /// Device or processor name.
  virtual std::string device() const = 0;
  virtual int threads() const = 0;
};

std::unique_ptr<WarpBackend> make_cpu_backend(const WarpPlan& plan);
std::unique_ptr<WarpBackend> make_cuda_backend(const WarpPlan& plan);
std::unique_ptr<WarpBackend> make_reference_backend(const WarpPlan& plan);

/// Name of CUDA device `device`, or why it does not answer.
BackendStatus cuda_status(int device);

/// Bytes of CUDA device `device` that can be had; 0 when it does not answer.
double free_device_memory(int device);

/// Page-locks host memory for CUDA devices. @returns whether it worked
bool cuda_lock_pages(void* data, std::size_t bytes);
void cuda_unlock_pages(void* data);

/// The processor's name.
std::string processor_name();

}  // namespace tetwarp
