/// @file contact.hpp
/// Solve one step of frictional, adhesive contact.
///
/// With K = diag(kappa_n, kappa_t, kappa_t), kappa = dt^2 area C beta^2, o = (0, gap_t / dt) and
/// nu = r + K (u + o), each contact obeys
///
///     0 <= nu_n  perpendicular to  u_n >= 0
///     |nu_t| <= R,  nu_t . u_t = -R |u_t|,  R = max(mu nu_n - chi |kappa_t (u_t + o_t)|, 0)
///
/// chi = 0: rule `parallel`; chi = 1: rule `restrictive`. Law `pyramid` takes |.| per tangent.
/// Sources: Gascon 2010/2013 (adhesion as constraints), Raous, Cangemi, Cocou 1999 (the model).
#pragma once
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/backend.hpp>
#include <tetwarp/choices.hpp>
#include <tetwarp/contact_problem.hpp>

namespace tetwarp {

enum class FrictionLaw { cone, pyramid };

/// How friction and tangential adhesion combine.
enum class AdhesionRule {
  parallel,    ///< spring and Coulomb slider side by side
  restrictive  ///< friction only tops the spring up: the larger of both resists sliding
};

/// What is done with islands of bodies that A couples, as it does the nodes of elastic bodies.
///
/// Iterated, with D the diagonal blocks of A and omega = `relaxation`:
///
///     v_f = v - omega D^-1 (A v - b),  sweeps in omega J D^-1 J^T,  v = v_f + omega D^-1 J^T r
///
/// It converges where omega lambda_max(D^-1 A) < 2, which 0.5 grants for tetrahedra. Anderson's
/// method accelerates v, or with method `nonlinear_cg` conjugate directions; with `gauss_seidel`
/// nothing does. `mass_splitting` and `newton` always condense. The eta that such an island reports
/// and is stopped by is a bound, above what residual_of() says (an estimate where one body has
/// several contacts).
/// Source: Otaduy et al. 2009 (iterative constraint anticipation).
enum class ContactCoupling {
  automatic,  ///< method `automatic`: large islands iterated, and condensed should that fail, or
              ///< have cost as much in a row with the same A and J (few contacts only), if they
              ///< have at most 2000 contacts; all else condensed
  condensed,  ///< sparse Cholesky of A, the Delassus matrix dense: 72 bytes per pair of contacts,
              ///< about three times over
  iterated    ///< outer block-Jacobi iteration around sweeps: memory as for A itself
};

enum class ContactPrecision { float64, float32 };

/// Work left out because it cannot change the solution beyond the tolerance.
struct ContactSkipOptions {
  bool frictionless_rows = true;   ///< contacts with kappa = 0 and mu = 0 are one row, not three
  bool debonded_springs = true;    ///< contacts with beta = 0 carry no springs
  bool contactless_bodies = true;  ///< parts of A that no contact reaches are solved apart from
                                   ///< those with contacts, linearly
  bool converged_islands = true;   ///< a converged island stops; all are checked at the end
  bool frozen_contacts = true;     ///< long converged contacts are revisited every few sweeps
  bool constant_systems = true;    ///< a ContactSolver condenses a coupled island once for all
                                   ///< problems in a row whose A and J are the same bits
};

/// Choices of a solve. Defaults give what most people want.
struct ContactOptions {
  FrictionLaw law = FrictionLaw::cone;
  AdhesionRule rule = AdhesionRule::parallel;
  ContactMethod method = ContactMethod::automatic;
  ContactMeasure measure = ContactMeasure::eta;
  double tolerance = 1e-6;
  std::int64_t max_sweeps = 20000;  ///< passes over all contacts of an island, all methods
  ContactCoupling coupling = ContactCoupling::automatic;
  double relaxation = 0.5;  ///< omega of the outer block-Jacobi iteration
  int inner_sweeps = 5;     ///< per outer iteration
  double recovery_speed = std::numeric_limits<double>::infinity();  ///< penetration is undone at
                                                                    ///< most this fast [m/s]
  ContactPrecision precision = ContactPrecision::float64;
  Backend backend = Backend::automatic;  ///< automatic: cpu, until contact has been measured on a
                                         ///< device
  int device = 0;                        ///< CUDA device number
  int threads = 0;  ///< of the cpu back end; 0: all cores. Same bits for any number
  ContactSkipOptions skip = {};
};

enum class ContactStatus {
  converged,
  not_converged,  ///< the best iterate is returned
  infeasible      ///< no velocity satisfies all contacts; offsets were clamped to a recovery speed
};

/// How far a pair of impulses and velocities is from solving a problem.
struct ContactResidual {
  double eta = 0;
  double fclib = 0;
  double largest = 0;  ///< largest share of one contact in eta: eta^2 sums their squares
  std::int64_t largest_contact = -1;  ///< whose that is; -1: no contact has any
  double penetration = 0;             ///< max(-u_n), m/s
  double balance = 0;                 ///< |A v - J^T r - b| / max(|b|, |J^T r|); 0 in local form
};

/// What a solve did. Field names of the JSON are an interface.
struct ContactReport {
  std::string version;
  Backend backend = Backend::cpu;
  std::string device;
  int threads = 1;
  std::string method;  ///< what ran, in order, for example "anderson, newton"
  ContactStatus status = ContactStatus::not_converged;
  std::string status_reason;  ///< one sentence when not converged
  std::int64_t contacts = 0;
  std::int64_t colors = 0;
  std::int64_t islands = 0;           ///< connected components that have contacts
  std::int64_t outer_iterations = 0;  ///< over coupled bodies, of the island that took most
  std::int64_t sweeps = 0;            ///< of the island that took most
  std::int64_t newton_iterations = 0;
  std::int64_t contact_updates = 0;      ///< local solves in all
  std::vector<double> residual_history;  ///< measured residual, whenever it was evaluated
  ContactResidual residual;              ///< of what is returned
  std::int64_t rows_skipped = 0;         ///< rows of contacts without friction and springs
  std::int64_t springs_skipped = 0;      ///< contacts with beta = 0
  std::int64_t bodies_skipped = 0;       ///< blocks that no contact reaches
  std::int64_t islands_stopped = 0;      ///< stopped before the last one
  std::int64_t updates_skipped = 0;      ///< local solves left out for frozen contacts
  std::int64_t condensations_kept = 0;   ///< coupled islands condensed by an earlier solve
  double setup_seconds = 0;
  double solve_seconds = 0;
  double total_seconds = 0;
};

/// The report as a JSON object.
std::string to_json(const ContactReport& report);

/// Results of a solve.
struct ContactSolution {
  std::vector<double> impulse;        ///< r, [3 contacts], N s
  std::vector<double> velocity;       ///< u, [3 contacts], m/s
  std::vector<double> body_velocity;  ///< v, [dofs]; empty in local form
  ContactReport report;

  bool converged() const { return report.status == ContactStatus::converged; }
};

/// How the adhesion intensity is stepped.
enum class AdhesionIntegrator {
  exact,          ///< the piecewise linear law in closed form
  explicit_euler  ///< clamped to [0, 1]; for comparison
};

struct EvolutionOptions {
  AdhesionIntegrator integrator = AdhesionIntegrator::exact;
  double debond_gap_factor = 10;   ///< a contact lets go beyond this multiple of sqrt(W / C)
  double debond_intensity = 1e-3;  ///< or below this in traction
};

/// Adhesion at the start of the next step.
struct AdhesionStep {
  std::vector<double> intensity;       ///< beta, [contacts]
  std::vector<double> gap;             ///< [contacts][3], m, anchors rescaled where beta grew
  std::vector<std::uint8_t> debonded;  ///< 1 where the contact let go in this step
};

/// Solves problem after problem, keeping buffers, and as long as the structure stays the same the
/// colors and islands too. Same inputs in the same order, same bits, whatever the number of
/// threads. Not safe for concurrent calls.
class ContactSolver {
 public:
  /// @throws std::invalid_argument  on options out of range, naming them
  /// @throws CudaError              when cuda was asked for and no device answers
  explicit ContactSolver(const ContactOptions& options = {});
  ContactSolver(ContactSolver&&) noexcept;
  ContactSolver& operator=(ContactSolver&&) noexcept;
  ~ContactSolver();

  /// @throws ContactProblemError  see check_problem(); never for a problem that is merely hard
  ContactSolution solve(const ContactProblem& problem);

  /// evolve_adhesion() where this solver runs.
  AdhesionStep evolve(const ContactProblem& problem,
                      const ContactSolution& solution,
                      const EvolutionOptions& options = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// One problem. For several keep a ContactSolver.
ContactSolution solve_contacts(const ContactProblem& problem, const ContactOptions& options = {});

/// Residuals of a given pair, in float64, with the true A. Empty `body_velocity`: computed from the
/// impulses (local form: u = W r + q).
ContactResidual residual_of(const ContactProblem& problem,
                            std::span<const double> impulse,
                            std::span<const double> body_velocity,
                            const ContactOptions& options = {});

/// One step of adhesion intensity and anchor gaps after a solve (beta is frozen within it), on the
/// host.
AdhesionStep evolve_adhesion(const ContactProblem& problem,
                             const ContactSolution& solution,
                             const EvolutionOptions& options = {});

}  // namespace tetwarp
