/// @file condensed_solver.hpp
/// CondensedSolver: contact islands of joined bodies, by the matrix of their contacts.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/simulate/solve/contact_shares.hpp"
#include "host/simulate/solve/problem/contact_constants.hpp"
#include "host/simulate/solve/problem/contact_rows.hpp"
#include "host/simulate/step/cpu/rest_factors.hpp"
#include "host/simulate/step/cpu/row_range_lu.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

/// For bodies that springs join and for cloth, where contacts are few and factors of A have few
/// entries: the Delassus matrix W = J A^-1 J^T is made by solves, and the contact solver finds r in
/// u = W r + q, the local form of ContactProblem. It takes no outer iterations, however stiff
/// springs and bodies are, and its residual is that of A.
///
/// Determinism: serial; what it takes depends on counted multiplications.
class CondensedSolver {
 public:
  /// Of a contact island.
  struct Limits {
    std::int64_t contacts;
    std::int64_t operations;  ///< multiplications of factors and of solves for columns
  };
  /// Where the iteration over bodies would take about as long, and where it has failed.
  static constexpr Limits at_first{100, 30'000'000}, later{400, 400'000'000};

  explicit CondensedSolver(const ContactOptions& options);

  /// Moves the contact islands that it solves to another share.
  /// @param rows     J of all contacts
  /// @param laws     of all contacts
  /// @param factors  of elastic bodies: contact islands of bodies that each have one stay, and so
  ///                 do those that have neither friction nor elastic bodies
  void take(const Limits& limits,
            const SystemRows& system,
            const ContactIslands& islands,
            const ContactRows& rows,
            const ContactProblem& laws,
            const RestFactors& factors,
            ContactShare& from,
            ContactShare& to);
  /// Solves what take() has moved. What does not converge is a status.
  /// @param system    of the step, in memory of the host
  /// @param laws      of all contacts
  /// @param velocity  out: with contact, [block_count]
  /// @returns null: the system is singular, or so near to it that W is none of contacts
  const ContactReport* solve(const StepSystem& system,
                             const ContactRows& rows,
                             const ContactProblem& laws,
                             const ContactShare& share,
                             std::vector<Point3>& velocity);

  /// r and u of the contacts of the last solve(), [3 contacts].
  const std::vector<double>& impulse() const { return solution_.impulse; }
  const std::vector<double>& contact_velocity() const { return solution_.velocity; }

 private:
  /// A coupling island.
  struct Island {
    std::int64_t begin = 0, end = 0;  ///< rows of the system
    RowRangeLu lu;
    RowRangeLu* factors = nullptr;       ///< of the linear solve, or `lu`
    std::vector<double> values;          ///< of A, for which `factors` and columns have been made
    std::vector<std::int32_t> contacts;  ///< places in the share
    std::vector<std::vector<double>> rows;  ///< [contacts] J: of each block its row, nine numbers
    std::vector<double> columns;            ///< A^-1 J^T, [contacts][3][3 rows]
    std::vector<std::vector<double>> kept_rows;  ///< of the last solve
    std::vector<double> kept_columns;
  };
  /// Of a contact island; operations beyond the limits: it is not taken.
  struct Cost {
    std::int64_t contacts = 0, rows = 0, operations = 0;
    bool has_joined = false, has_elastic = false, has_friction = false;
  };

  void find_rows(const SystemRows& system, const ContactIslands& islands);
  void find_kinds(const ContactIslands& islands,
                  const ContactProblem& laws,
                  const RestFactors& factors,
                  const ContactShare& share);
  void find_costs(const Limits& limits,
                  const SystemRows& system,
                  const ContactIslands& islands,
                  const ContactRows& rows,
                  const ContactShare& share);
  bool find_factors(const StepSystem& system, const ContactShare& share);
  void list_contacts(const ContactRows& rows, const ContactShare& share);
  void find_velocities(const StepSystem& system, const ContactShare& share);
  void find_columns(Island& island) const;
  void set_matrix(const ContactRows& rows, const ContactShare& share);
  bool is_valid(std::size_t contact_count) const;
  void set_problem(const ContactRows& rows, const ContactProblem& laws, const ContactShare& share);
  /// Calls visit(island, row, J) for the blocks with unknowns of a contact; J row by row.
  template <class Visit>
  void for_rows(const ContactRows& rows, std::int32_t contact, const Visit& visit) const;

  ContactSolver solver_;
  std::vector<Island> islands_;              ///< [coupling islands]
  std::vector<std::int32_t> island_of_row_;  ///< [rows with unknowns]
  std::vector<std::int32_t> row_of_block_;   ///< [block_count], or -1
  std::vector<Cost> costs_;                  ///< [coupling islands] set at the roots
  std::vector<double> force_;                ///< [rows][3] b + J^T r, then v
  std::vector<double> matrix_;               ///< W, [contacts][contacts][9], row by row
  std::vector<std::uint8_t> has_block_;      ///< [contacts][contacts]
  ContactConstantsList laws_;
  ContactProblem problem_;
  ContactSolution solution_;
};

}  // namespace tetwarp
