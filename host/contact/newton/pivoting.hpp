/// @file pivoting.hpp
/// Lemke's pivoting for small contact problems with the friction pyramid.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include <tetwarp/contact.hpp>

namespace tetwarp {

/// With the pyramid the laws of contact are linear complementarity conditions. Per contact, with
/// nu_t = b+ - b- for each tangent and a slip speed g for each,
///
///     0 <= nu_n _|_ u_n >= 0,   0 <= b+- _|_ g +- u_t >= 0,   0 <= g _|_ mu nu_n - b+ - b- >= 0
///
/// Lemke's method follows a path of solutions of a problem with a multiple of a positive vector
/// added to the right sides until that multiple is 0. Paths of other vectors lead to other
/// solutions, or to none: a path can end in a ray although there is a solution.
///
/// Source: Stewart, Trinkle 1996 (the conditions); Lemke 1965.
class FrictionPivoting {
 public:
  /// Contacts above which a path takes longer than Newton's method from some starts.
  static constexpr std::int64_t max_contacts = 32;

  /// Whether the laws of a problem are such conditions.
  static bool applies(const ContactProblem& problem, const ContactOptions& options);

  /// @pre applies(problem, options)
  FrictionPivoting(const ContactProblem& problem, const ContactOptions& options);

  /// The end of the path of one positive vector.
  /// @param start  seed of the vector
  /// @return  impulses [3 contacts], the conditions hold to 1e-6 or better; none where the path
  /// ends
  ///          in a ray, or is lost by rounding
  ///
  /// Determinism: serial; same bits. Cost: some 10 pivots per contact, each 200 times the square of
  /// the contacts.
  std::optional<std::vector<double>> solve(std::uint32_t start) const;

 private:
  Eigen::MatrixXd matrix_;         ///< of the conditions, 7 per contact
  Eigen::VectorXd right_side_;     ///< of the conditions
  Eigen::MatrixXd velocity_;       ///< u = velocity_ nu + free_velocity_
  Eigen::VectorXd free_velocity_;  ///< without nu, with springs
  Eigen::VectorXd stiffness_;      ///< of the springs, [3 contacts]
  Eigen::VectorXd offset_;         ///< of the springs, [3 contacts]
};

}  // namespace tetwarp
