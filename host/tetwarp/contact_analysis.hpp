/// @file contact_analysis.hpp
/// What a solution of a contact problem means contact by contact, and where its energy goes. Both
/// cost a factorization of A, so they are computed on request only.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/contact.hpp>
#include <tetwarp/export.hpp>

namespace tetwarp {

/// Which branch of its law a contact is in, by the natural map of docs/contact.md.
enum class ContactMode : std::uint8_t {
  open,     ///< neither closed nor held
  stick,    ///< closed, without sliding
  slide,    ///< closed and at the bound of friction, which may be 0
  adhering  ///< held by its spring: it carries traction or would, and does not touch
};

/// Per contact: in which branch of its law it is, and how far from it.
struct ContactModes {
  std::vector<ContactMode> mode;           ///< [contacts]
  std::vector<double> residual;            ///< share of each contact in eta, [contacts]: eta^2 is
                                           ///< the sum of the squares of all three vectors
  std::vector<double> bilateral_residual;  ///< of groups of bilateral rows, and after them those
                                           ///< of springs at contacts with a friction ellipse
  std::vector<double> rolling_residual;    ///< of entries of rolling friction
};

/// Mode and residual of every contact.
/// @param solution  impulses, velocities and body velocities are read
/// @param options   law, rule and recovery_speed are read
/// @throws std::invalid_argument  an array has the wrong size
/// @throws ContactProblemError    as ContactSolver::solve()
TETWARP_EXPORT ContactModes contact_modes(const ContactProblem& problem,
                                          const ContactSolution& solution,
                                          const ContactOptions& options = {});

/// Energies of a step [J], in global form. With the free motion v_f = A^-1 b,
///
///     after - free = offset_work + bilateral_work - friction_loss - rolling_loss - impact_loss
///                    - bilateral_loss - adhesion_loss - (adhesion_after - adhesion_before) + error
///
/// Follows from A (v - v_f) = J^T r + J_b^T lambda, multiplied by v. error is what A v = b + J^T r
/// lacks: rounding for condensed and rigid bodies.
struct EnergyBalance {
  double before = 0;     ///< 1/2 v_0 . A v_0 with the velocities at the start; 0: not given
  double load_work = 0;  ///< free - before: work of external impulses; 0 without velocities
  double free = 0;       ///< 1/2 v_f . A v_f: of the motion without contacts
  double after = 0;      ///< 1/2 v . A v

  double offset_work = 0;      ///< of velocity offsets w: restitution, recovery from penetration,
                               ///< obstacles and surfaces that move
  double bilateral_work = 0;   ///< lambda . target, of motors and stretched couplings
  double friction_loss = 0;    ///< -nu_t . u_t, at least 0
  double rolling_loss = 0;     ///< -m . omega, at least 0
  double impact_loss = 0;      ///< 1/2 (v - v_f) . A (v - v_f): what stops at once in the step
  double bilateral_loss = 0;   ///< sum of compliance lambda^2
  double adhesion_before = 0;  ///< of stretched springs, 1/2 kappa (gap / dt)^2, at the start
  double adhesion_after = 0;   ///< and at the end of the step, beta as in the step
  double adhesion_loss = 0;    ///< of the implicit step of these springs, at least 0
  double error = 0;            ///< what the equation above lacks
};

/// The energies of a solved step, in global form; costs a factorization of A.
/// @param solution        impulses, velocities and body velocities are read
/// @param start_velocity  v at the start of the step, [dofs], m/s or rad/s, or empty
/// @throws std::invalid_argument  an array has the wrong size, or the problem is in local form,
///                                which has no masses
/// @throws ContactProblemError    as ContactSolver::solve()
TETWARP_EXPORT EnergyBalance energy_balance(const ContactProblem& problem,
                                            const ContactSolution& solution,
                                            std::span<const double> start_velocity = {});

}  // namespace tetwarp
