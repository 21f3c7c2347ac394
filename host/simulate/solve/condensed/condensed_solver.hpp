/// @file condensed_solver.hpp
/// CondensedSolver: contact islands of joined bodies, by the matrix of their contacts.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/simulate/solve/condensed/condensed_choice.hpp"
#include "host/simulate/solve/condensed/condensed_matrix.hpp"
#include "host/simulate/solve/problem/contact_constants.hpp"

namespace tetwarp {

/// For bodies that springs join and for cloth, where contacts are few and factors of A have few
/// entries: the Delassus matrix W = J A^-1 J^T is made by solves, and the contact solver finds r in
/// u = W r + q, the local form of ContactProblem. It takes no outer iterations, however stiff
/// springs and bodies are, and its residual is that of A.
///
/// Determinism: serial; what it takes depends on counted multiplications.
class CondensedSolver {
 public:
  using Limits = CondensedChoice::Limits;
  /// Where the iteration over bodies would take about as long, and where it has failed.
  static constexpr Limits at_first{100, 30'000'000}, later{400, 400'000'000};

  /// @param islands  kept by the caller
  /// @param factors  of elastic bodies; kept by the caller
  CondensedSolver(const ContactOptions& options,
                  const ContactIslands& islands,
                  const RestFactors& factors);

  /// Moves the contact islands that it solves to another share.
  /// @param rows  J of all contacts
  /// @param laws  of all contacts
  void take(const Limits& limits,
            const SystemRows& system,
            const ContactRows& rows,
            const ContactProblem& laws,
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
  bool find_matrix(const StepSystem& system, const ContactRows& rows, const ContactShare& share);
  void find_velocities(const StepSystem& system, const ContactShare& share);
  void set_problem(const ContactProblem& laws, const ContactShare& share);

  ContactSolver solver_;
  const ContactIslands& islands_;
  CondensedChoice choice_;
  SystemIslands places_;
  std::vector<CondensedIsland> coupling_;  ///< [coupling islands]
  BlockJacobian jacobian_;                 ///< of the contacts of the share
  CondensedMatrix matrix_;
  std::vector<double> velocity_;  ///< [rows][3] J^T r, then v
  ContactConstantsList laws_;
  ContactProblem problem_;
  ContactSolution solution_;
};

}  // namespace tetwarp
