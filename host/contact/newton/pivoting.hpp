/// @file pivoting.hpp
/// Lemke's pivoting for small contact problems with the friction pyramid.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include <tetwarp/contact.hpp>

namespace tetwarp {

/// With the friction pyramid the laws of contact are linear complementarity conditions. For each
/// contact, with nu_t = b+ - b- along each tangent and a slip speed g for each tangent,
///
///     0 <= nu_n _|_ u_n >= 0,   0 <= b+- _|_ g +- u_t >= 0,   0 <= g _|_ mu nu_n - b+ - b- >= 0
///
/// Lemke's method adds a multiple of a positive vector to the right sides and follows a path of
/// solutions along which the multiple decreases. Where it is 0, the conditions are solved. Paths of
/// different vectors lead to different solutions; a path can also end in a ray although there is a
/// solution.
///
/// Source: Stewart, Trinkle 1996 (the conditions); Lemke 1965.
class FrictionPivoting {
 public:
  /// With more contacts a path takes longer than Newton's method from some starts.
  static constexpr std::int64_t max_contacts = 32;

  /// Whether the laws of a problem are such conditions.
  static bool applies(const ContactProblem& problem, const ContactOptions& options);

  /// @pre applies(problem, options)
  FrictionPivoting(const ContactProblem& problem, const ContactOptions& options);

  /// Follows the path of one positive vector to its end.
  /// @param start  seed of the vector
  /// @return  impulses [3 contacts] for which the conditions hold to 1e-6 or better; none if the
  ///          path ends in a ray or rounding errors prevent a solution
  ///
  /// Determinism: serial; same bits. Cost: about 10 pivots per contact, each 200 times the square
  /// of the number of contacts.
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
