/// @file contact_problem.hpp
/// The data of one time step of frictional, adhesive contact.
///
/// Letters in comments: A system, J jacobian, b load, w velocity offset, W delassus, q free
/// velocity, r impulse, u relative velocity at the contacts, v velocity of the degrees of freedom
/// (dofs) of the bodies, mu friction, beta adhesion intensity.
#pragma once
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <tetwarp/export.hpp>

namespace tetwarp {

/// Sparse matrix by rows (CSR). Columns of a row need not be sorted; repeated entries add up.
struct SparseMatrix {
  std::int64_t rows = 0;
  std::int64_t columns = 0;
  std::vector<std::int64_t> row_start;  ///< [rows + 1], first 0, never decreasing
  std::vector<std::int32_t> column;     ///< [entries], in [0, columns)
  std::vector<double> value;            ///< [entries], finite

  bool empty() const { return rows == 0; }
};

/// Adhesion of each contact. Every vector has one entry per contact (gap: three) or is empty, which
/// means zeros; an empty `tangential_stiffness` means the same as `stiffness`.
struct AdhesionState {
  double time_step = 0;                      ///< dt [s], > 0 where any contact adheres
  std::vector<double> area;                  ///< [m^2], >= 0
  std::vector<double> stiffness;             ///< C_n [N/m^3], >= 0
  std::vector<double> tangential_stiffness;  ///< C_t [N/m^3], >= 0
  std::vector<double> intensity;             ///< beta, from 0 (debonded) to 1 (bonded)
  std::vector<double> gap;        ///< [contact][normal, tangent 1, tangent 2], m: between the two
                                  ///< material points that were bonded, at the start of the step
  std::vector<double> energy;     ///< W, adhesion energy [J/m^2], >= 0
  std::vector<double> viscosity;  ///< eta [J s/m^2], >= 0; 0: no debonding
  std::vector<double> bonding_rate;         ///< r [1/(Pa s)], >= 0
  std::vector<double> saturation_pressure;  ///< p0 [Pa], >= 0

  bool empty() const { return intensity.empty(); }
};

/// Rows beyond those of contacts that hold with either sign, in the global form only: joints, and
/// couplings of bodies. With J_b = `jacobian` and the impulse lambda of each row,
///
///     A v = J^T r + J_b^T lambda + b,  J_b v + compliance lambda = target
///
/// A spring of stiffness k over a step dt is a row of compliance 1 / (k dt^2) and target -g / dt, g
/// its stretch at the start of the step.
struct BilateralRows {
  SparseMatrix jacobian;           ///< J_b, [rows][dofs]; every row has a nonzero entry
  std::vector<double> target;      ///< [rows], m/s or rad/s; empty: zeros
  std::vector<double> compliance;  ///< [rows], >= 0, 1/kg or 1/(kg m^2); empty: zeros, hard rows
  std::vector<std::int32_t> group_start;  ///< first row of each group, then the row count: groups
                                          ///< of one to three rows are solved together; a joint of
                                          ///< more rows has several groups. Empty: single rows
  std::vector<double> impulse_guess;      ///< lambda to start from, [rows], or empty: zeros

  bool empty() const { return jacobian.empty(); }
  std::int64_t row_count() const { return jacobian.rows; }
};

/// Resistance of contacts to rolling and to spinning about the normal, in the global form only. Per
/// entry three rows: the angular velocity omega of body a relative to body b about the normal,
/// tangent 1 and tangent 2 of the contact [rad/s]. The angular impulses m [N m s] obey
///
///     |m_n| <= torsion nu_n,  m_n omega_n = -torsion nu_n |omega_n|
///     |m_t| <= rolling nu_n,  m_t . omega_t = -rolling nu_n |omega_t|,  |.| of the vector of two
struct RollingFriction {
  std::vector<std::int32_t> contact;  ///< the contact of each entry, each at most once
  SparseMatrix jacobian;              ///< [3 entries][dofs]
  std::vector<double> rolling;        ///< [entries], m, >= 0
  std::vector<double> torsion;        ///< [entries], m, >= 0
  std::vector<double> impulse_guess;  ///< m to start from, [3 entries], or empty: zeros

  bool empty() const { return contact.empty(); }
  std::int64_t count() const { return static_cast<std::int64_t>(contact.size()); }
};

/// How the solver itself stores BilateralRows and RollingFriction: as blocks of three rows among
/// the contacts.
struct RowBlocks {
  std::vector<std::uint8_t> kind;     ///< [contacts], a ContactKind of the kernels
  std::vector<std::int32_t> contact;  ///< [contacts], of rolling friction: whose it is
  std::vector<double> torsion;        ///< [contacts], m

  bool empty() const { return kind.empty(); }
};

/// What the solver itself adds to a problem; empty in problems of a caller.
struct ContactProblemExpert {
  RowBlocks row_blocks;
};

/// Contacts of one step in one of two forms; the members of the other form stay empty:
///
///     global:  A v = J^T r + b,  u = J v + w        local:  u = W r + q
///
/// Each contact has three rows: normal, tangent 1, tangent 2. u_n is the normal gap at the end of
/// the step over dt, and w_n the one at its start over dt; the solver makes u_n >= 0. r_n > 0
/// pushes the bodies apart. Friction acts on u_t, springs on gap_t + dt u_t and on gap_n + dt (u_n
/// - w_n), in local form on dt u_n; gap_n not given: dt w_n. Restitution changes w_n, but not
/// gap_n.
struct ContactProblem {
  SparseMatrix system;                  ///< A, symmetric positive definite [kg, kg m^2]
  SparseMatrix jacobian;                ///< J, [3 contacts][dofs]; without contacts it may be empty
  std::vector<double> load;             ///< b, [dofs], N s
  std::vector<double> velocity_offset;  ///< w, [3 contacts], m/s
  SparseMatrix delassus;                ///< W, [3 contacts][3 contacts], 1/kg; may be asymmetric
  std::vector<double> free_velocity;    ///< q, [3 contacts], m/s: u without impulses, w included

  std::vector<double> friction;  ///< mu, [contacts], >= 0; its size is the number of contacts
  AdhesionState adhesion;
  std::vector<std::int32_t> block_start;  ///< first dof of each body or node, then the dof count;
                                          ///< empty: ranges of dofs that A does not couple, those
                                          ///< of more than 12 dofs cut into nodes of 3
  std::vector<double> impulse_guess;      ///< r to start from, [3 contacts], or empty: zeros

  std::vector<double> second_friction;  ///< mu along tangent 2, [contacts], >= 0, where that along
                                        ///< tangent 1, `friction`, differs: the bound of friction
                                        ///< is an ellipse. Empty: the same
  BilateralRows bilateral;
  RollingFriction rolling;
  ContactProblemExpert expert;  ///< of the solver; leave empty

  bool is_local() const { return !delassus.empty(); }
  std::int64_t contact_count() const { return static_cast<std::int64_t>(friction.size()); }
  std::int64_t dof_count() const { return system.rows; }
};

/// Invalid data in a ContactProblem. what() is one line: field, index, what is wrong, how to
/// correct it. field() is the name of the member as above ("friction", "adhesion.area", ...).
class TETWARP_EXPORT ContactProblemError : public std::invalid_argument {
 public:
  ContactProblemError(std::string field, const std::string& problem)
      : std::invalid_argument(field + problem), field_(std::move(field)) {}

  const std::string& field() const { return field_; }

 private:
  std::string field_;
};

/// Checks sizes, indices, signs and finiteness of everything that a solver reads. Every solve calls
/// it first.
/// @throws ContactProblemError  both forms given or none, W or A not square, mu < 0, beta outside
///                              [0, 1], negative area or stiffness, time_step <= 0 with adhesion,
///                              diagonal blocks of A that are not positive definite, rows of W
///                              without a positive normal diagonal, entries of W that contradict
///                              positive semidefiniteness, NaN or infinity anywhere; rows beyond
///                              contacts in local form, groups of more than three rows, negative
///                              compliance, rolling or torsion
///
/// Cost: a pass over all data and a Cholesky factorization of each diagonal block of A.
TETWARP_EXPORT void check_problem(const ContactProblem& problem);

}  // namespace tetwarp
