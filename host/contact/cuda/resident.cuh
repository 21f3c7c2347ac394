/// @file resident.cuh
/// A problem whose arrays are in memory of the device: its pattern there, checks, results.
#pragma once
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/base/vector_view.hpp"
#include "host/contact/cuda/device.hpp"
#include "host/contact/cuda/device_memory.cuh"
#include "host/contact/structure/structure.hpp"
#include "kernels/contact/contact_numbers.hpp"
#include "kernels/contact/resident_results.hpp"
#include "kernels/exec/exec_cuda.cuh"

namespace tetwarp {

class ResidentArrays {
 public:
  /// Copies the pattern to the device if the structure is another than at the last call.
  void set_pattern(CudaExec& exec, const ContactProblem& problem, std::int64_t structure_serial) {
    if (serial_ == structure_serial) return;
    arrays_.restart();
    const auto put = [&](const auto& values) { return arrays_.put(exec, view_of(values)); };
    const auto rows_of = [&](const SparseMatrix& matrix) {
      return RowsView{put(matrix.row_start), put(matrix.column)};
    };
    if (problem.is_local()) {
      rows_ = rows_of(problem.delassus);
    } else {
      rows_ = rows_of(problem.jacobian);
      std::vector<Zero> is_zero;
      for_each_deciding_number(problem, [&](std::size_t e) {
        is_zero.resize(problem.system.value.size(), Zero::either);
        is_zero[e] = problem.system.value[e] == 0 ? Zero::yes : Zero::no;
      });
      is_zero_ = put(is_zero);
    }
    serial_ = structure_serial;
  }

  /// The offsets w with normal ones of at least -speed, or q.
  View<const double> recovered(CudaExec& exec, const ContactInput& in, double speed) {
    if (in.load.size == 0 || speed == INFINITY) return in.given_velocity;
    recovered_.resize(in.given_velocity.size);
    exec.for_each("contact/setup", in.friction.size,
                  RecoveryOp{in.given_velocity, speed, view_of(recovered_)});
    return view_of(std::as_const(recovered_));
  }

  /// Whether the checks of the host would pass, the pattern is still the same, and every normal
  /// spring has the gap dt w_n. Reads one number.
  /// @param numbers  of the problem, filled
  bool is_plain(CudaExec& exec,
                const ResidentProblem& problem,
                const ContactIndices& indices,
                const ContactNumbers<double>& numbers) {
    constexpr const char* label = "contact/setup";
    constexpr double most = 0x1.fffffffffffffp1023;
    const ContactInput& in = problem.input;
    if (in.has_adhesion && !(in.time_step > 0 && in.time_step <= most)) return false;
    const std::int64_t contacts = in.friction.size;
    checks_.resize(check_count);
    largest_.resize(1);
    const View<BadCount> checks = view_of(checks_);
    exec.make_zeros(checks_, check_count);

    RangeCheckOp range;
    for (const View<const double> any :
         {in.matrix, in.jacobian, in.load, in.given_velocity, in.gap, problem.guess}) {
      range.add(any, -most, most);
    }
    for (const View<const double> positive :
         {in.friction, in.area, in.stiffness, in.tangential_stiffness}) {
      range.add(positive, 0, most);
    }
    range.add(in.intensity, 0, 1);
    exec.sum_to(label, 0, range.total, range, &checks[0]);

    const ContactScalesOp scales{in, rows_, indices.is_local};
    exec.sum_to(label, 0, contacts, scales, &view_of(largest_)[0]);
    const LargestOf<2>* const largest = view_of(largest_).data;
    exec.sum_to(label, 0, contacts, ContactCheckOp{scales, largest}, &checks[1]);
    if (indices.is_local) {
      exec.sum_to(label, 0, 3 * contacts, SemidefiniteCheckOp{scales, largest}, &checks[2]);
    } else {
      exec.sum_to(label, 0, is_zero_.size, ZeroPatternOp{in.matrix, is_zero_}, &checks[2]);
      exec.sum_to(
          label, 0, indices.blocks(),
          BlockCheckOp{indices.pairs.dof_start, indices.diagonal_value, numbers.system.values},
          &checks[3]);
    }
    const auto bad = exec.sum<BadCount>(label, 0, check_count,
                                        ReadySums<BadCount>{View<const BadCount>(checks)});
    return bad.value[0] == 0;
  }

  /// Writes impulses and velocities to the arrays of the caller.
  /// @param numbers        of the problem, filled
  /// @param impulse        [3 slots]
  /// @param body_velocity  by places, [dofs]
  /// @return  sums over them
  ResultSums write_results(CudaExec& exec,
                           const ResidentProblem& problem,
                           const ContactIndices& indices,
                           const ContactNumbers<double>& numbers,
                           View<const double> impulse,
                           View<const double> body_velocity) {
    constexpr const char* label = "contact/result";
    const ContactInput& in = problem.input;
    const auto target = [](View<double> given, std::int64_t size, DeviceVector<double>& own) {
      if (given.size > 0) return given;
      own.resize(size);
      return view_of(own);
    };
    const View<double> r = target(problem.impulse, impulse.size, impulse_);
    const View<double> u = target(problem.velocity, impulse.size, velocity_);
    const View<double> v = target(problem.body_velocity, body_velocity.size, body_velocity_);
    exec.for_each(label, indices.slots(), ScatterItemsOp<3>{indices.contact_of_slot, impulse, r});
    exec.for_each(label, indices.dofs(), ScatterItemsOp<1>{indices.dof_of_place, body_velocity, v});
    const View<const double> x = indices.is_local ? View<const double>(r) : View<const double>(v);
    exec.for_each(
        label, r.size,
        RowResultOp{rows_, indices.is_local ? in.matrix : in.jacobian, x, in.given_velocity, u});
    sums_.resize(2);
    const View<ResultSums> sums = view_of(sums_);
    exec.sum_to(label, 0, r.size, ContactResultOp{r, u}, &sums[0]);
    exec.sum_to(label, 0, indices.blocks(),
                BalanceSumsOp{numbers.system, numbers.block_contacts, numbers.bodies.jacobian,
                              numbers.load, impulse, body_velocity},
                &sums[1]);
    return exec.sum<ResultSums>(label, 0, 2, ReadySums<ResultSums>{View<const ResultSums>(sums)});
  }

 private:
  static constexpr std::int64_t check_count = 4;

  std::int64_t serial_ = 0;  ///< of the structure that the pattern belongs to
  DeviceArrays arrays_;
  RowsView rows_;             ///< of J or W
  View<const Zero> is_zero_;  ///< [stored numbers of A], or empty: they may all be zero or not
  DeviceVector<double> recovered_, impulse_, velocity_, body_velocity_;
  DeviceVector<BadCount> checks_;
  DeviceVector<LargestOf<2>> largest_;
  DeviceVector<ResultSums> sums_;
};

}  // namespace tetwarp
