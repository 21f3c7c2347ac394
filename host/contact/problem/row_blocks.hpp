/// @file row_blocks.hpp
/// Rewrites problems with bilateral rows, rolling friction and friction ellipses, so that the
/// solver needs only blocks of three rows.
///
/// - Every group of bilateral rows, and every entry of rolling friction, becomes a block of three
///   rows of J, after the contacts; rows that a group does not have are empty.
/// - A compliant row gets a dof of its own, with 1 / compliance on the diagonal of A: its velocity
///   is compliance lambda, and the row becomes a hard one.
/// - A contact with friction mu_1 and mu_2 along its tangents becomes one with the larger of both,
///   mu, and with tangential rows multiplied by e_a = mu_a / mu. Then r_a = e_a r'_a, and its cone
///   |(r'_1, r'_2)| <= mu r_n is the ellipse. Its tangential springs become a compliant block.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/contact.hpp>

namespace tetwarp {

/// Whether block `c` of a problem is a contact; false: bilateral or rolling.
bool is_contact_block(const ContactProblem& problem, std::size_t c);

/// Whether any block of a problem is one of rolling friction.
bool has_rolling(const ContactProblem& problem);

/// Whether a problem has anything that BlockProblem rewrites.
bool needs_blocks(const ContactProblem& problem);

class BlockProblem {
 public:
  /// @param given  has passed check_problem(); kept by the caller
  /// @throws ContactProblemError  a combination that `options` cannot solve
  BlockProblem(const ContactProblem& given, const ContactOptions& options);

  /// The problem of blocks: first the contacts, then the groups of bilateral rows, rolling friction
  /// and the tangential springs of contacts with a friction ellipse.
  const ContactProblem& problem() const { return blocks_; }

  /// Sets the impulses and body velocities of a solution from those of the blocks.
  void set_solution(std::span<const double> impulse,
                    std::span<const double> body_velocity,
                    ContactSolution& solution) const;

  /// Impulses of the blocks, the inverse of set_solution().
  /// @throws std::invalid_argument  an array of the solution has the wrong size
  std::vector<double> impulse_of(const ContactSolution& solution) const;

  /// Body velocities of the blocks, those of compliant rows included.
  /// @param impulse  impulse_of(solution)
  std::vector<double> body_velocity_of(const ContactSolution& solution,
                                       std::span<const double> impulse) const;

 private:
  void scale_tangents();
  void add_groups();
  void add_rolling();
  void add_springs();
  void add_row(const SparseMatrix& rows, std::int64_t row, double offset, double compliance);
  void end_block(std::uint8_t kind, double friction, std::int32_t contact, double torsion);

  const ContactProblem& given_;
  ContactProblem blocks_;
  std::vector<double> scale_;             ///< e, [contacts][2]; empty: all 1
  std::vector<std::int32_t> sprung_;      ///< contacts with a spring block
  std::vector<double> compliance_;        ///< of the dofs after those of the given problem
  std::vector<std::int64_t> row_of_dof_;  ///< the row of J that each of them belongs to
};

}  // namespace tetwarp
