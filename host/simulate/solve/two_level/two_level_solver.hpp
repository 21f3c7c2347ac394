/// @file two_level_solver.hpp
/// Contacts of deformable and coupled bodies: outer iterations over bodies, sweeps over contacts.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/base/stopwatch.hpp"
#include "host/simulate/solve/problem/following_motion.hpp"
#include "host/simulate/solve/problem/soft_problem.hpp"
#include "host/simulate/solve/two_level/touching_blocks.hpp"
#include "host/simulate/solve/two_level/two_level_control.hpp"
#include "kernels/contact/anderson.hpp"

namespace tetwarp {

/// Solves A v = b + J^T r with the laws of contact, from the velocities without contact. With
/// M^-1 = omega D^-1, D the diagonal blocks of A, or R A_0^-1 R^T for single elastic bodies
/// (ElasticSpace),
///
///     v_f = v + M^-1 (b + J^T r - A v)
///     sweeps change r in  u = J v_f + J M^-1 J^T (r - r before) + w
///     v = v_f + M^-1 J^T (r - r before)
///
/// with Anderson acceleration of v, with elastic bodies from the second iteration on and as long as
/// the equations are further from their solution than the laws, and acceleration of r in the
/// sweeps. It has converged where the defect of A v = b + J^T r in the norm of M^-1 and the natural
/// map of the laws are together at most `tolerance` times the sum of the square root of the work of
/// the impulses and of the natural map without impulses, or as small as the error of the velocities
/// without contact.
///
/// It ends, without having converged, after a number of operations, and where its residual no
/// longer shrinks, as of bodies that are squeezed so that no velocities satisfy all contacts. The
/// result then is the iterate with the least residual.
///
/// Determinism: same bits for any number of threads.
class TwoLevelSolver {
 public:
  /// @param factors  of the elastic bodies
  TwoLevelSolver(const Model& model,
                 const ContactOptions& options,
                 std::shared_ptr<RestFactors> factors);

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
  struct Chunk {
    std::int32_t row_begin = 0, row_end = 0;
    std::int32_t island = 0;  ///< in SolvedIslands::list()
  };

  void prepare(const StepSystem& system,
               const SoftProblem& problem,
               const std::vector<Point3>& velocity);
  void list_chunks(const SystemRows& rows);
  double step(const StepSystem& system);
  void step_chunk(std::int64_t chunk);
  TwoLevelError find_error(double defect);
  std::int64_t most_of_iteration() const;
  std::int64_t sweep(double enough);
  double sweep_working();
  template <class Accelerator, class Follow>
  void sweep_accelerated(const std::vector<std::int32_t>& list,
                         double enough,
                         const Follow& follow,
                         std::int64_t& sweeps);
  void sweep_listed(const std::vector<std::int32_t>& list, double enough, std::int64_t& sweeps);
  void gather_impulses(const std::vector<std::int32_t>& list);
  void scatter_impulses(const std::vector<std::int32_t>& list);
  End iterate(const StepSystem& system, bool ends_early, TwoLevelOutcome& outcome);
  void take_best(TwoLevelOutcome& outcome);
  double step_elastic();
  void add_elastic();

  /// The iterate with the least residual.
  struct Best {
    double residual = 0;
    std::vector<double> x, impulse;
  };

  const Model& model_;
  ContactOptions options_;
  ContactSwitches switches_;
  int threads_;
  double relaxation_;  ///< omega
  Stopwatch clock_;    ///< since the start of the solve
  std::shared_ptr<RestFactors> factors_;
  SolvedIslands islands_;
  ElasticSpace elastic_;
  TouchingBlocks blocks_;
  std::vector<Chunk> chunks_;
  std::vector<double> inverse_;
  DiagonalInverse<double> diagonal_;
  std::vector<double> x_, product_, force_;  ///< [rows][3]
  std::vector<double> y_;                    ///< as TouchingBlocks
  std::vector<double> weights_, mixed_;
  std::vector<double> pull_, moved_;  ///< [rows][3] of elastic bodies
  std::vector<double> stepped_;       ///< [3 contacts] impulses of the last step()
  std::vector<double> elastic_squares_;
  std::vector<double> squares_;                            ///< [chunks] parts of d . omega D^-1 d
  double least_error_ = 0;                                 ///< of the velocities without contact
  std::vector<double> impulse_, contact_velocity_, free_;  ///< [3 contacts]
  std::vector<double> before_, swept_, unaccelerated_, listed_diagonal_,
      accelerated_;  ///< of sweep()
  std::vector<std::int64_t> moved_places_;
  FollowingMotion motion_;
  std::vector<std::int32_t> pushing_;  ///< contacts with impulses
  std::vector<double> group_squares_;  ///< [groups] squares of changes
  Best best_;
};

}  // namespace tetwarp
