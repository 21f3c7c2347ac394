/// @file two_level_solver.hpp
/// Contacts of deformable and coupled bodies: outer iterations over bodies, sweeps over contacts.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/base/stopwatch.hpp"
#include "host/exec/exec_cpu.hpp"
#include "host/simulate/solve/two_level/compliant_list_maker.hpp"
#include "host/simulate/solve/two_level/residual_check.hpp"
#include "host/simulate/solve/two_level/touching_blocks.hpp"
#include "host/simulate/solve/two_level/touching_newton.hpp"
#include "host/simulate/solve/two_level/two_level_step.hpp"
#include "host/simulate/solve/two_level/two_level_sweeps.hpp"
#include "kernels/contact/anderson.hpp"
#include "kernels/contact/coupled_iteration.hpp"

namespace tetwarp {

/// Solves A v = b + J^T r with the laws of contact by the iteration of coupled_iteration.hpp, from
/// the velocities without contact, with M^-1 = omega D^-1, D the diagonal blocks of A, or
/// R A_0^-1 R^T for single elastic bodies (ElasticSpace). Sweeps change r (TwoLevelSweeps).
///
/// Without elastic bodies and friction Newton's method (TouchingNewton) comes first where a
/// factorization of A with its contacts has few multiplications, else once the iteration has had
/// as many; where it fails, the iteration goes on.
///
/// Anderson's method accelerates v; with elastic bodies only from the second iteration on, and only
/// while the error of the equations is larger than that of the laws. The iteration has converged
/// where the errors of equations and laws are together at most `tolerance` times the sum of the
/// square roots of the work of the impulses and of the natural map without impulses, or at most the
/// error of the velocities without contact (CoupledControl).
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
  CoupledOutcome solve(const StepSystem& system,
                       const SoftProblem& problem,
                       std::vector<Point3>& velocity);

  /// r and u of the contacts of the last solve(), [3 contacts].
  const std::vector<double>& impulse() const { return impulse_; }
  const std::vector<double>& contact_velocity() const { return contact_velocity_; }

  // What solve_coupled() calls, which says what they do.
  using Next = CoupledControl::Next;
  CpuExec& exec() { return exec_; }
  View<double> now() { return part_of(x_); }
  View<double> image() { return part_of(y_); }
  View<const double> weights() { return part_of(weights_); }
  View<double> mixed();
  bool has_elastic() const { return !elastic_.bodies().empty(); }
  Next start(double damping, CoupledOutcome& outcome);
  CoupledControl control(bool ends_early);
  std::optional<CoupledError> find_error(const CoupledOutcome& outcome);
  void keep(double residual);
  double excess(const CoupledOutcome& outcome);
  Next limit(const CoupledOutcome& outcome);
  void solve_contacts(double enough, CoupledOutcome& outcome);
  void take_image();

 private:
  using Mixer = AndersonMixer<CpuExec, double>;
  /// The iterate with the least residual.
  struct Best {
    double residual = 0;
    std::vector<double> x, impulse;
  };

  const CompliantLists& lists() const { return maker_.lists(); }
  /// The numbers of rows.
  View<double> part_of(std::vector<double>& values) const {
    return {values.data(), 3 * lists().row_count()};
  }
  void prepare(double damping);
  CoupledControl control(bool ends_early, double tolerance);
  Next find_by_newton(CoupledOutcome& outcome);
  bool is_newton_due(const CoupledOutcome& outcome);
  void go_on_by_newton(CoupledOutcome& outcome);
  bool goes_on(std::int64_t sweeps) const;
  void take_best();
  bool is_small() const;

  ContactOptions options_;
  ContactSwitches switches_;
  int threads_;
  CpuExec exec_;
  Stopwatch clock_;  ///< since the start of the solve
  // Of the present solve.
  const StepSystem* system_ = nullptr;
  const SoftProblem* problem_ = nullptr;
  const std::vector<Point3>* start_ = nullptr;  ///< velocities without contact
  std::shared_ptr<RestFactors> factors_;
  CompliantListMaker maker_;
  TwoLevelStart given_;
  std::vector<std::uint8_t> bare_;  ///< [bodies of the model] see ElasticSpace::find_bare()
  ElasticSpace elastic_;
  TouchingBlocks blocks_;
  TwoLevelStep step_;
  TwoLevelSweeps sweeps_;
  TouchingNewton newton_;
  ResidualCheck check_;
  std::vector<double> x_, force_;        ///< [rows][3]
  std::vector<double> y_;                ///< as TouchingBlocks has it
  std::vector<double> weights_, mixed_;  ///< of AndersonMixer
  std::vector<std::int32_t> working_;    ///< contacts, of TouchingBlocks::measure()
  std::vector<double> stepped_;          ///< [3 contacts] impulses of the last step
  std::vector<double> impulse_, contact_velocity_, free_;  ///< [3 contacts]
  double work_ = 0;                                        ///< of the last impulses
  double checked_ = 0;                                     ///< eta by the last run of check_
  bool is_ended_ = false;                                  ///< by the caller, within check_
  double least_error_ = 0;                                 ///< of the velocities without contact
  std::int64_t product_operations_ = 0;                    ///< multiplications of a product with A
  /// Multiplications of the iteration after which Newton's method follows, or is asked for its own.
  std::int64_t newton_at_ = 0;
  bool has_newton_ = false;  ///< whether they are those after which it follows
  Best best_;
};

}  // namespace tetwarp
