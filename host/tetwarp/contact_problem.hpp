/// @file contact_problem.hpp
/// One time step of frictional, adhesive contact, as data.
///
/// Letters in comments: A system, J jacobian, b load, W delassus, q free velocity, r or lambda
/// impulse, u relative velocity at the contacts, v generalised velocity, mu friction.
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
  std::vector<std::int64_t> row_start;  ///< [rows + 1], first 0, never falling
  std::vector<std::int32_t> column;     ///< [entries], in [0, columns)
  std::vector<double> value;            ///< [entries], finite

  bool empty() const { return rows == 0; }
};

/// Adhesion of each contact. Every vector is empty (none of that effect; C_t: as C_n; gap: zero
/// tangents) or has one entry per contact.
struct AdhesionState {
  double time_step = 0;                      ///< dt [s], > 0 where any contact adheres
  std::vector<double> area;                  ///< [m^2], >= 0
  std::vector<double> stiffness;             ///< C_n [N/m^3], >= 0
  std::vector<double> tangential_stiffness;  ///< C_t [N/m^3], >= 0
  std::vector<double> intensity;             ///< beta, 0 debonded to 1 bonded
  std::vector<double> gap;                   ///< [contact][normal, tangent 1, tangent 2], m, of the
                                             ///< material anchors at the start of the step
  std::vector<double> energy;                ///< W [J/m^2], >= 0
  std::vector<double> viscosity;             ///< eta [J s/m^2], >= 0; 0: no debonding
  std::vector<double> bonding_rate;          ///< r [1/(Pa s)], >= 0
  std::vector<double> saturation_pressure;   ///< p0 [Pa], >= 0

  bool empty() const { return intensity.empty(); }
};

/// Contacts of one step, in one of two forms (the other form's members stay empty):
///
///     global:  A v = J^T r + b,  u = J v + w        local:  u = W r + q
///
/// Per contact three rows: normal, tangent 1, tangent 2. u_n >= 0 is the end-of-step normal gap
/// over dt (w_n = start-of-step gap / dt); friction acts on u_t, the adhesive spring on
/// (gap_t + dt u_t). r_n > 0 pushes apart. An adhesion `gap` normal, when given, equals dt w_n.
struct ContactProblem {
  SparseMatrix system;                  ///< A, symmetric positive definite [kg, kg m^2]
  SparseMatrix jacobian;                ///< J, [3 contacts][dofs]
  std::vector<double> load;             ///< b, [dofs], N s
  std::vector<double> velocity_offset;  ///< w, [3 contacts], m/s
  SparseMatrix delassus;                ///< W, [3 contacts][3 contacts], 1/kg; may be asymmetric
  std::vector<double> free_velocity;    ///< q, [3 contacts], m/s, offset included

  std::vector<double> friction;  ///< mu, [contacts], >= 0; its size is the number of contacts
  AdhesionState adhesion;
  std::vector<std::int32_t> block_start;  ///< first dof of each body or node, then the dof count;
                                          ///< empty: connected blocks of A up to 12 dofs, else 3
  std::vector<double> impulse_guess;      ///< r to start from, [3 contacts], or empty

  bool is_local() const { return !delassus.empty(); }
  std::int64_t contact_count() const { return static_cast<std::int64_t>(friction.size()); }
  std::int64_t dof_count() const { return system.rows; }
};

/// A problem that cannot be solved as it stands. `what()` is one line: field, index, what is wrong,
/// what would mend it. `field()` is the member's name as above ("friction", "adhesion.area", ...).
class TETWARP_EXPORT ContactProblemError : public std::invalid_argument {
 public:
  ContactProblemError(std::string field, const std::string& problem)
      : std::invalid_argument(field + problem), field_(std::move(field)) {}

  const std::string& field() const { return field_; }

 private:
  std::string field_;
};

/// Checks sizes, indices, signs and finiteness of everything a solver reads, before any of it is
/// used: both forms mixed or none, W or A not square, mu < 0, beta outside [0, 1], negative area or
/// stiffness, time_step <= 0 with adhesion, a normal gap that disagrees with dt w_n by more than
/// 1e-9 relative, diagonal blocks of A that are not positive definite, rows of W without a positive
/// normal diagonal, NaN or infinity anywhere.
/// @throws ContactProblemError
TETWARP_EXPORT void check_problem(const ContactProblem& problem);

}  // namespace tetwarp
