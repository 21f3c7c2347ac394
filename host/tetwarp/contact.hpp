/// @file contact.hpp
/// Solves one time step of frictional, adhesive contact: impulses and velocities from a
/// ContactProblem.
///
/// Per contact, r is the impulse [N s], u the relative velocity at the end of the step [m/s], mu
/// the friction coefficient and beta the adhesion intensity. The adhesive springs, linear in the
/// displacement of the step, are K = diag(kappa_n, kappa_t, kappa_t) [kg], kappa = dt^2 area C
/// beta^2. With o = (gap_n / dt - w_n, gap_t / dt), usually (0, gap_t / dt), nu = r + K (u + o) is
/// the impulse that contact and friction carry without the springs. Each contact obeys
///
///     0 <= nu_n  perpendicular to  u_n >= 0
///     |nu_t| <= R,  nu_t . u_t = -R |u_t|,  R = max(mu nu_n - chi |kappa_t (u_t + o_t)|, 0)
///
/// chi = 0: AdhesionRule::parallel; chi = 1: AdhesionRule::restrictive. FrictionLaw::cone takes |.|
/// of the tangential vector, FrictionLaw::pyramid of each tangential component.
/// Sources: Gascon 2010/2013 (adhesion as constraints), Raous, Cangemi, Cocou 1999 (the model).
#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <tetwarp/backend.hpp>
#include <tetwarp/choices.hpp>
#include <tetwarp/contact_adhesion.hpp>
#include <tetwarp/contact_arrays.hpp>
#include <tetwarp/contact_problem.hpp>
#include <tetwarp/export.hpp>

namespace tetwarp {

/// Bound of the friction impulse.
enum class FrictionLaw {
  cone,    ///< Coulomb: |nu_t| <= R
  pyramid  ///< |nu_t1| <= R and |nu_t2| <= R; depends on the directions of the tangents
};

/// How friction and tangential adhesion combine.
enum class AdhesionRule {
  parallel,    ///< adhesive spring and Coulomb friction in parallel: both resist sliding in full
  restrictive  ///< friction adds only what the spring lacks: the larger of both resists sliding
};

/// How islands of contacts are solved whose bodies A couples, as it couples the nodes of an elastic
/// body. `automatic` is the one to use; the others are for experts.
///
/// Iterated, with D the diagonal blocks of A and omega = ContactExpertOptions::relaxation:
///
///     v_f = v - omega D^-1 (A v - b),  sweeps in omega J D^-1 J^T,  v = v_f + omega D^-1 J^T r
///
/// This converges if omega lambda_max(D^-1 A) < 2, which omega = 0.5 satisfies for meshes of
/// tetrahedra. Anderson acceleration is applied to v; ContactMethod::nonlinear_cg uses conjugate
/// directions instead, `gauss_seidel` no acceleration. ContactMethod `newton`
/// always condenses. For an iterated island, eta is an upper bound of what residual_of() computes
/// (an estimate where one body has several contacts), because the exact value needs a factorization
/// of A.
/// Source: Otaduy et al. 2009 (iterative constraint anticipation).
enum class ContactCoupling {
  automatic,  ///< ContactMethod::automatic iterates large islands and condenses them if that fails
              ///< (at most 2000 contacts); a ContactSolver also condenses an island once the
              ///< iterations of successive problems with the same A and J have cost as much. Small
              ///< islands and all other methods: condensed
  condensed,  ///< sparse Cholesky factorization of A and a dense Delassus matrix, which takes 72
              ///< bytes per pair of contacts, held about twice
  iterated    ///< outer block-Jacobi iteration around sweeps; memory proportional to that of A
};

/// Arithmetic of sweeps; results are always measured in float64. Iterations over bodies that A
/// couples are in float64.
enum class ContactPrecision { float64, float32 };

/// Work that is left out because it cannot change the solution by more than the tolerance; a member
/// set to false has that work done.
struct ContactSkipOptions {
  bool frictionless_rows = true;   ///< contacts with kappa = 0 and mu = 0 are one row, not three
  bool debonded_springs = true;    ///< contacts with beta = 0 have no springs
  bool contactless_bodies = true;  ///< bodies that are connected to no contact are solved
                                   ///< separately, by A v = b alone
  bool converged_islands = true;   ///< a converged island stops before the others do
  bool frozen_contacts = true;     ///< contacts whose impulse has stopped changing are updated in
                                   ///< every 8th sweep only (ContactMethod::gauss_seidel)
  bool constant_systems = true;    ///< a ContactSolver condenses a coupled island once for all
                                   ///< successive problems whose A and J have the same bits
};

/// Choices for comparing methods. The defaults suit all problems; the solution is the same within
/// the tolerance.
struct ContactExpertOptions {
  ContactCoupling coupling = ContactCoupling::automatic;
  double relaxation = 0.5;  ///< omega of the outer block-Jacobi iteration, in (0, 2)
  int inner_sweeps = 5;     ///< sweeps per outer iteration, >= 1
  ContactSkipOptions skip = {};
};

/// How far a running solve is.
struct ContactProgress {
  double seconds = 0;                  ///< since its start
  std::int64_t sweeps = 0;             ///< of all islands together
  std::int64_t newton_iterations = 0;  ///< linear systems solved
};

/// Options of a solve. The defaults suit most problems.
struct ContactOptions {
  FrictionLaw law = FrictionLaw::cone;
  AdhesionRule rule = AdhesionRule::parallel;
  ContactMethod method = ContactMethod::automatic;  ///< others are for comparisons
  ContactMeasure measure = ContactMeasure::eta;     ///< what `tolerance` bounds
  double tolerance = 1e-6;                          ///< of `measure`, relative, > 0
  std::int64_t max_sweeps = 100000;  ///< passes over all contacts of an island, of all methods,
                                     ///< >= 1
  double recovery_speed = std::numeric_limits<double>::infinity();  ///< existing penetration is
                                                                    ///< undone at most this fast
                                                                    ///< [m/s], >= 0
  ContactPrecision precision = ContactPrecision::float64;
  Backend backend = Backend::automatic;  ///< see choose_contact_backend()
  int device = 0;                        ///< CUDA device number
  int threads = 0;  ///< of the cpu back end, to 1024, 0: all cores; any number: same bits
  ContactExpertOptions expert = {};

  // Limits of a solve, which then returns the best iterate so far, with status `not_converged` and
  // the limit in status_reason. Results depend on the clock only if max_seconds is set. Not
  // interrupted, so that they can exceed a limit of time: a single factorization, the structure of
  // a new sparsity pattern, a kernel on a device, back end `reference`.
  double max_seconds = std::numeric_limits<double>::infinity();  ///< wall time of a solve [s], > 0
  /// Factorizations of Newton's method and of the method of multipliers in a solve, >= 0.
  std::int64_t max_newton = std::numeric_limits<std::int64_t>::max();
  /// Memory of one factorization [bytes], estimated before it is made; 0: 20 times that of the
  /// arrays of the problem, at least `least_memory`. Islands that must not be condensed are
  /// iterated; Newton's method is left out where its factors would be larger.
  std::int64_t max_memory = 0;
  static constexpr double least_memory = 256e6;
  /// Called after every sweep, Newton step and phase, from the thread that solves; returns false to
  /// end the solve. What it throws leaves solve(). Must not use the solver.
  std::function<bool(const ContactProgress&)> progress = {};
};

enum class ContactStatus {
  converged,
  not_converged,  ///< the best iterate is returned
  infeasible,     ///< no velocity satisfies all contacts; negative normal offsets of contacts that
                  ///< contradict each other were raised to 0
  unbounded  ///< not converged, and impulses can grow without bound: a direction of impulses in
             ///< the friction cones causes no velocity, and the contacts approach along it.
             ///< No proof that there is no solution, since contacts that slide can release
             ///< these impulses. The best iterate is returned
};

/// How far impulses and velocities are from a solution.
struct ContactResidual {
  double eta = 0;      ///< ContactMeasure::eta, relative
  double fclib = 0;    ///< ContactMeasure::fclib, relative
  double largest = 0;  ///< largest contribution of one contact: eta^2 is the sum of their squares
  std::int64_t largest_contact = -1;  ///< index of that contact; -1: all contributions are 0. From
                                      ///< the contact count on: groups of bilateral rows, then
                                      ///< entries of rolling friction
  double penetration = 0;             ///< max(-u_n), m/s
  double balance = 0;                 ///< |A v - J^T r - b| / max(|b|, |J^T r|); 0 in local form
};

/// What a solve did. The field names of its JSON form are stable.
struct ContactReport {
  std::string version;
  Backend backend = Backend::cpu;  ///< the one that ran
  std::string device;              ///< name of the processor or CUDA device
  int threads = 1;
  std::string method;  ///< methods that ran, in order, for example "anderson, newton"
  ContactStatus status = ContactStatus::not_converged;
  std::string status_reason;  ///< one sentence when not converged
  std::int64_t contacts = 0;
  std::int64_t bilateral_rows = 0;    ///< of the problem
  std::int64_t rolling_contacts = 0;  ///< with rolling friction
  std::int64_t colors = 0;   ///< most colors of an island; contacts of a color share no body
  std::int64_t islands = 0;  ///< connected components of bodies that have contacts
  std::int64_t outer_iterations = 0;  ///< of the coupled island that took the most
  std::int64_t sweeps = 0;            ///< of the island that took the most
  std::int64_t multiplier_steps = 0;  ///< Newton steps of the method of multipliers, in all
  std::int64_t newton_iterations = 0;
  std::int64_t contact_updates = 0;      ///< solves of a single contact, in all
  std::vector<double> residual_history;  ///< `measure` each time it was evaluated
  ContactResidual residual;              ///< of the solution returned
  std::int64_t rows_skipped = 0;         ///< rows of contacts without friction and springs
  std::int64_t springs_skipped = 0;      ///< contacts with beta = 0
  std::int64_t bodies_skipped = 0;       ///< blocks of bodies that are connected to no contact
  std::int64_t islands_stopped = 0;      ///< islands that stopped before the last one
  std::int64_t updates_skipped = 0;      ///< solves of frozen contacts that were left out
  std::int64_t condensations_kept = 0;   ///< coupled islands that an earlier solve had condensed
  double setup_seconds = 0;
  double solve_seconds = 0;
  double total_seconds = 0;
};

/// The report as a JSON object.
TETWARP_EXPORT std::string to_json(const ContactReport& report);

struct ContactSolution {
  std::vector<double> impulse;            ///< r, [3 contacts], N s
  std::vector<double> velocity;           ///< u, [3 contacts], m/s
  std::vector<double> body_velocity;      ///< v, [dofs]; empty in local form
  std::vector<double> bilateral_impulse;  ///< lambda of ContactProblem::bilateral, [rows]
  std::vector<double> rolling_impulse;    ///< m of ContactProblem::rolling, [3 entries], N m s
  ContactReport report;

  bool converged() const { return report.status == ContactStatus::converged; }
};

/// The back end that a contact solve with this choice runs on, and the reason in one sentence.
/// `automatic` means cpu: for contact, cuda is used only if requested, until it has been
/// measured on a device.
/// @param requested  ContactOptions::backend
/// @param device  CUDA device number
/// @throws CudaError  cuda is requested and device `device` is not usable
TETWARP_EXPORT std::pair<Backend, std::string> choose_contact_backend(Backend requested,
                                                                      int device = 0);

/// Solves a series of problems and keeps its buffers between them, and colors and islands while the
/// sparsity pattern stays the same.
///
/// Determinism: the same problems in the same order give the same bits for any number of threads.
/// Not safe for concurrent calls.
class TETWARP_EXPORT ContactSolver {
 public:
  /// @throws std::invalid_argument  an option is out of range; the text names it
  /// @throws CudaError              cuda was requested and the device is not usable
  explicit ContactSolver(const ContactOptions& options = {});
  ContactSolver(ContactSolver&&) noexcept;
  ContactSolver& operator=(ContactSolver&&) noexcept;
  ~ContactSolver();

  /// A problem that does not converge is no error: see ContactReport::status.
  /// @throws ContactProblemError  the problem fails check_problem(), or a factorization of A shows
  ///                              that it is not positive definite
  ContactSolution solve(const ContactProblem& problem);

  /// Makes islands and colors for the problems that solve(ContactArrays) gets from now on: those
  /// with the index arrays of this one and zeros among the stored numbers of A in the same places,
  /// with block_start only among those outside of its blocks.
  /// @throws ContactProblemError    as solve()
  /// @throws std::invalid_argument  the problem has second_friction, bilateral rows or rolling
  ///                                friction
  void set_structure(const ContactProblem& problem);

  /// Solves the problem of set_structure() with new numbers; the results have the bits of the call
  /// above with the same numbers in host memory.
  ///
  /// Arrays on a device stay there: counts and sums are copied, no array. Through the host go, with
  /// all arrays copied in both directions: islands whose bodies A couples, problems with an island
  /// that sweeps do not converge, normal springs with another gap than dt w_n, blocks of A of more
  /// than 12 dofs, numbers that check_problem() may refuse. Returns when the results are written.
  /// @return  the report; ContactResidual::balance is summed in another order
  /// @throws std::invalid_argument  set_structure() was not called, a size differs from that of its
  ///                                problem, device memory without back end cuda, an address that
  ///                                is not in memory of the device
  /// @throws ContactProblemError    as above; nothing was written
  /// @throws CudaError              a call of the device failed
  ContactReport solve(const ContactArrays& arrays, const ContactTarget& target);

  /// evolve_adhesion() on this solver's back end.
  AdhesionStep evolve(const ContactProblem& problem,
                      const ContactSolution& solution,
                      const EvolutionOptions& options = {});

  /// The same for arrays, which stay where they are; reads impulse and velocity of `solution`.
  void evolve(const ContactArrays& arrays,
              const ContactTarget& solution,
              const AdhesionArrays& adhesion,
              const EvolutionOptions& options = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Solves one problem; throws as ContactSolver, which is faster for a series of problems.
TETWARP_EXPORT ContactSolution solve_contacts(const ContactProblem& problem,
                                              const ContactOptions& options = {});

/// Residuals of given impulses and velocities, in float64, by a factorization of A.
/// @param impulse        r, [3 contacts], N s
/// @param body_velocity  v, [dofs], m/s, or empty: computed from r. Local form: u = W r + q
/// @param options        law, rule and recovery_speed are read
/// @throws std::invalid_argument  an array has the wrong size, or the problem has bilateral rows or
///                                rolling friction: use the function below
/// @throws ContactProblemError    as ContactSolver::solve()
TETWARP_EXPORT ContactResidual residual_of(const ContactProblem& problem,
                                           std::span<const double> impulse,
                                           std::span<const double> body_velocity,
                                           const ContactOptions& options = {});

/// The same for a whole solution, also with rows beyond those of contacts; its report is not read.
TETWARP_EXPORT ContactResidual residual_of(const ContactProblem& problem,
                                           const ContactSolution& solution,
                                           const ContactOptions& options = {});

/// Adhesion intensities and anchor gaps after a solve, which keeps beta constant; runs on the host.
/// @param solution  of `problem`: impulse and velocity are read
/// @return empty arrays for a problem without adhesion
/// @throws std::invalid_argument  impulse or velocity has the wrong size, or an option is out of
///                                range
/// @throws ContactProblemError    an array of the adhesion has the wrong size, or time_step <= 0
TETWARP_EXPORT AdhesionStep evolve_adhesion(const ContactProblem& problem,
                                            const ContactSolution& solution,
                                            const EvolutionOptions& options = {});

}  // namespace tetwarp
