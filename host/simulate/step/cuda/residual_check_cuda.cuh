/// @file residual_check_cuda.cuh
/// ResidualCheckCuda: the residual eta of a two-level iterate on a device.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "host/simulate/step/cuda/two_level_numbers.cuh"
#include "kernels/contact/cuda/residual_check.cuh"
#include "kernels/exec/device_limits.cuh"

namespace tetwarp {

/// One launch of a grid, and one read.
class ResidualCheckCuda {
 public:
  /// An iterate in memory of the device.
  struct Iterate {
    View<const double> velocity;  ///< v, [rows][3]
    View<double> defect, moved;   ///< b + J^T r - A v in frames, and work; both are overwritten
    CheckedContacts contacts;
    double work;  ///< r . (u - u without impulses) [J]
  };

  explicit ResidualCheckCuda(int device) : limits_(device_limits(device)) {}

  /// Whether the device can synchronize a grid.
  bool is_possible() const { return limits_.is_cooperative; }
  /// Takes memory. @param contacts, rows  numbers of their vectors
  void resize(std::int64_t contacts, std::int64_t rows) {
    for (Vector* v : {&x_, &direction_, &product_}) v->resize(rows);
    caused_.resize(contacts);
    lower_.resize(contacts / 3);
    sums_.resize(GridTeam::sum_bytes(std::max(rows, contacts / 3)));
    state_.resize(1);
  }
  /// @param most_at_once  iterations of a launch
  /// @param goes_on       () -> whether to continue; asked between launches
  /// @returns eta; infinite where the velocities are not found
  template <class GoesOn>
  double run(CudaExec& exec,
             const TwoLevelNumbers& numbers,
             ContactSwitches switches,
             const ResidualCheckLimits& limits,
             const Iterate& at,
             std::int64_t most_at_once,
             const GoesOn& goes_on) {
    const TouchingNodes& touching = numbers.touching();
    exec.for_each("body/contact", lower_.view().size,
                  LowerTouchOp{touching.bodies, touching.rows, numbers.constants(), lower_.view()});
    ResidualCheckJob job = {
        numbers.gradients(x_.view(), at.defect, at.moved, direction_.view(), product_.view()),
        touching.rows,
        at.velocity,
        at.contacts,
        const_view(lower_),
        switches,
        caused_.view(),
        limits.negligible(at.work),
        limits.least_scale,
        most_at_once,
        true,
        sums_.view().data,
        std::max(x_.view().size, lower_.view().size),
        state_.view().data};
    for (;; job.is_first = false) {
      launch_cooperative(exec.stream(), residual_check_kernel<GridTeam>,
                         dim3(blocks_of(x_.view().size / 3)), dim3(sum_threads),
                         GridTeam::shared_bytes, job);
      const ResidualCheckState state = exec.load(state_.view().data);
      if (state.progress.end == CausedProgress::End::found) return state.eta;
      if (state.progress.end == CausedProgress::End::lost || !goes_on()) {
        return std::numeric_limits<double>::infinity();
      }
    }
  }

 private:
  using Vector = DeviceVector<double>;

  /// A warp for each row, or as many blocks as are resident together.
  unsigned blocks_of(std::int64_t rows) const {
    int resident = 0;
    check_cuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(
                   &resident, residual_check_kernel<GridTeam>, sum_threads, GridTeam::shared_bytes),
               "cudaOccupancyMaxActiveBlocksPerMultiprocessor");
    return static_cast<unsigned>(
        std::min((32 * rows + sum_threads - 1) / sum_threads, resident * limits_.multiprocessors));
  }

  DeviceLimits limits_;
  Vector x_, direction_, product_;  ///< [rows][3], in frames
  Vector caused_;                   ///< [3 contacts]
  DeviceVector<ContactConstants<double>> lower_;
  DeviceVector<std::byte> sums_;
  DeviceVector<ResidualCheckState> state_;
};

}  // namespace tetwarp
