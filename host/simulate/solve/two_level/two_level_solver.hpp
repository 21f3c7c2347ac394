/// @file two_level_solver.hpp
/// Contacts of deformable and coupled bodies: outer iterations over bodies, sweeps over contacts.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/base/stopwatch.hpp"
#include "host/simulate/solve/problem/soft_problem.hpp"
#include "host/simulate/solve/two_level/touching_blocks.hpp"
#include "host/simulate/solve/two_level/touching_newton.hpp"
#include "host/simulate/solve/two_level/two_level_control.hpp"
#include "host/simulate/solve/two_level/two_level_step.hpp"
#include "host/simulate/solve/two_level/two_level_sweeps.hpp"

namespace tetwarp {

/// Solves A v = b + J^T r with the laws of contact, from the velocities without contact. With
/// M^-1 = omega D^-1, D the diagonal blocks of A, or R A_0^-1 R^T for single elastic bodies
/// (ElasticSpace),
///
///     v_f = v + M^-1 (b + J^T r - A v)
///     sweeps change r in  u = J v_f + J M^-1 J^T (r - r before) + w
///     v = v_f + M^-1 J^T (r - r before)
///
/// Without elastic bodies and friction, and where a factorization of A with its contacts has few
/// multiplications, Newton's method (TouchingNewton) comes first.
///
/// Anderson's method accelerates v; with elastic bodies only from the second iteration on, and only
/// while the error of the equations is larger than that of the laws. Sweeps accelerate r
/// (TwoLevelSweeps). The iteration has converged where the errors of equations and laws are
/// together at most `tolerance` times the sum of the square roots of the work of the impulses and
/// of the natural map without impulses, or at most the error of the velocities without contact
/// (TwoLevelControl).
///
/// It ends without having converged after a number of operations, and where its residual no longer
/// shrinks, as of bodies that are squeezed so that no velocities satisfy all contacts. The result
/// then is the iterate with the least residual.
///
/// Determinism: same bits for any number of threads.
class TwoLevelSolver {
 public:
  /// @param factors  of the elastic bodies
  TwoLevelSolver(const Model& model,
                 const ContactOptions& options,
                 std::shared_ptr<RestFactors> factors);
  TwoLevelSolver(const TwoLevelSolver&) = delete;
  TwoLevelSolver& operator=(const TwoLevelSolver&) = delete;

  /// @param velocity  in: without contact, [block_count]; out, if there is a result: with contact
  TwoLevelOutcome solve(const StepSystem& system,
                        const SoftProblem& problem,
                        std::vector<Point3>& velocity);

  /// r and u of the contacts of the last solve(), [3 contacts].
  const std::vector<double>& impulse() const { return impulse_; }
  const std::vector<double>& contact_velocity() const { return contact_velocity_; }

  const std::shared_ptr<RestFactors>& factors() const { return factors_; }

 private:
  enum class End : std::uint8_t { converges, diverges, fails, is_stopped };
  /// The iterate with the least residual.
  struct Best {
    double residual = 0;
    std::vector<double> x, impulse;
  };

  void prepare(const StepSystem& system,
               const SoftProblem& problem,
               const std::vector<Point3>& velocity);
  TwoLevelError find_error(double defect);
  TwoLevelControl control(bool ends_early, double tolerance);
  TwoLevelControl::Next measure(const StepSystem& system,
                                TwoLevelControl& control,
                                TwoLevelOutcome& outcome);
  End iterate(const StepSystem& system, bool ends_early, TwoLevelOutcome& outcome);
  End find_by_newton(const StepSystem& system, TwoLevelOutcome& outcome);
  void take_best(TwoLevelOutcome& outcome);
  bool is_small() const;

  ContactOptions options_;
  ContactSwitches switches_;
  int threads_;
  double relaxation_;  ///< omega
  Stopwatch clock_;    ///< since the start of the solve
  std::shared_ptr<RestFactors> factors_;
  TakenIslands islands_;
  ElasticSpace elastic_;
  TouchingBlocks blocks_;
  TwoLevelStep step_;
  TwoLevelSweeps sweeps_;
  TouchingNewton newton_;
  std::vector<double> x_, force_;        ///< [rows][3]
  std::vector<double> y_;                ///< as TouchingBlocks has it
  std::vector<double> weights_, mixed_;  ///< of AndersonMixer
  std::vector<std::int32_t> working_;    ///< contacts, of TouchingBlocks::measure()
  std::vector<double> stepped_;          ///< [3 contacts] impulses of the last step
  std::vector<double> impulse_, contact_velocity_, free_;  ///< [3 contacts]
  double least_error_ = 0;                                 ///< of the velocities without contact
  TwoLevelError error_;                                    ///< of the present iterate
  Best best_;
};

}  // namespace tetwarp
