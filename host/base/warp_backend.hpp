/// @file warp_backend.hpp
/// The interface between Warper and the back ends. Arguments have been checked before.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <tetwarp/curved_mesh.hpp>
#include <tetwarp/warp.hpp>

namespace tetwarp {

/// Checked arguments of a Warper and the geometry that no step changes.
struct WarpPlan {
  std::vector<VolumeView> sources;
  Mesh mesh;  ///< its last tetrahedra are those that the hexahedra were split into
  std::vector<MidNodes> mid_nodes;  ///< of its first tetrahedra; empty: none has ten nodes
  WarpOptions options;
  Region source_region;  ///< of the source grid: voxels that the sources' data hold
  Grid output_grid;      ///< the whole output grid
  Region region;         ///< part of it to compute
  Grid target_grid;      ///< grid of the region
};

/// A back end: cpu, cuda or reference. A step has five parts, each called once and in the order of
/// declaration; when a part throws, the step is over. Up to two steps, numbers 0 and 1, are in
/// flight. Before settle() of the earlier step only upload() of the later one is called; before the
/// last two parts of the earlier one also compute().
class WarpBackend {
 public:
  virtual ~WarpBackend() = default;

  /// Copies the positions; host memory may change afterwards.
  virtual void upload(int flight, const PositionsView& deformed) = 0;
  /// Computes the step, or queues it on the device. The target's memory stays valid until finish().
  virtual void compute(int flight, const WarpTarget& target, const Progress& progress) = 0;
  /// Waits until the step is computed. @throws its errors
  virtual void settle(int) {}
  /// Queues the copy of the result to the target.
  virtual void download(int) {}
  /// Waits for the copy of download(). @returns the report without the total time
  virtual StepReport finish(int flight) = 0;
  /// Waits until all queued work has ended.
  virtual void drain() noexcept {}

  /// Device or processor name.
  virtual std::string device() const = 0;
  virtual int threads() const = 0;
};

std::unique_ptr<WarpBackend> make_cpu_backend(const WarpPlan& plan);
std::unique_ptr<WarpBackend> make_cuda_backend(const WarpPlan& plan);
std::unique_ptr<WarpBackend> make_reference_backend(const WarpPlan& plan);

/// Name of CUDA device number `device`, or why it is not usable.
BackendStatus cuda_status(int device);

/// Free memory of CUDA device number `device` [byte], without what the stacks of kernels may take;
/// 0 when it is not usable.
TETWARP_EXPORT double free_device_memory(int device);

/// Page-locks host memory for CUDA devices. @returns whether it succeeded
bool cuda_lock_pages(void* data, std::size_t bytes);
void cuda_unlock_pages(void* data);

std::string processor_name();

}  // namespace tetwarp
