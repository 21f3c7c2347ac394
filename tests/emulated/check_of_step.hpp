/// @file check_of_step.hpp
/// The check of convergence of the two-level iteration by a grid of the emulated device.
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "tests/simulate/random_step.hpp"

#include "kernels/contact/cuda/residual_check.cuh"

namespace tetwarp::test {

/// A random step as a check has it, on the host's own arrays.
class CheckOfStep {
 public:
  explicit CheckOfStep(std::int32_t size) : size_(size), step_(size) {
    for (std::int64_t i = 0; i < step_.diagonal_rows().size; ++i) {
      DiagonalInvertOp{step_.diagonal_rows(), {step_.system(), step_.values(), of_.diagonal}}(i);
    }
    for (auto& own : lower_) {
      own = {};
      own.block[0] = own.block[4] = own.block[8] = own.tangent_metric = 2;
      own.friction = 0.5;
      own.kind = ContactKind::coulomb;
    }
  }

  /// @param most  iterations of a launch
  ResidualCheckState run(unsigned blocks, std::int64_t most) {
    ResidualCheckState state;
    std::vector<double> r(defect_.data(), defect_.data() + defect_.size());
    std::vector<double> x(r.size()), z(r.size()), p(r.size()), q(r.size()), caused(r.size());
    std::vector<LargestSum> sums(
        index_of(GridTeam::sum_bytes(3 * size_) / static_cast<std::int64_t>(sizeof(LargestSum))));
    ResidualCheckJob job = {
        {of_, step_.system(), step_.values(), view(x), view(r), view(z), view(p), view(q)},
        touching_,
        read(velocity_),
        {read(impulse_), read(contact_velocity_), read(free_), read(zeros_)},
        view(std::as_const(lower_)),
        {},
        view(caused),
        0,
        0,
        most,
        true,
        sums.data(),
        3 * size_,
        &state};
    for (; state.progress.end == CausedProgress::End::open; job.is_first = false) {
      simt::launch_cooperative(residual_check_kernel<GridTeam>, dim3(blocks), dim3(sum_threads),
                               GridTeam::shared_bytes, job);
    }
    return state;
  }

 private:
  static View<const double> read(const Eigen::VectorXd& v) { return {v.data(), v.size()}; }

  std::int32_t size_;
  RandomStep step_;
  std::vector<float> compliance_;
  std::vector<double> inverse_;
  CompliantBodies of_ = step_.compliant(compliance_, inverse_);
  Eigen::VectorXd offset_ = step_.vector(3 * size_), defect_ = step_.vector(3 * size_),
                  velocity_ = step_.vector(3 * size_), impulse_ = step_.vector(3 * size_),
                  contact_velocity_ = step_.vector(3 * size_), free_ = step_.vector(3 * size_),
                  zeros_ = Eigen::VectorXd::Zero(3 * size_);
  TouchingRows touching_ = step_.touching(offset_);
  std::vector<ContactConstants<double>> lower_ =
      std::vector<ContactConstants<double>>(index_of(size_));
};

}  // namespace tetwarp::test
