/// @file modes.cpp
/// contact_modes().
#include <cmath>
#include <tetwarp/contact_analysis.hpp>

#include "host/contact/problem/residual.hpp"

namespace tetwarp {
namespace {
/// The branch of the natural map; see natural_energy().
ContactMode mode_of(const MeasuredContact& contact,
                    const Eigen::Vector3d& impulse,
                    const Eigen::Vector3d& velocity,
                    const ContactOptions& options) {
  const NaturalTerms terms = natural_terms(contact, impulse, velocity, options.law, options.rule);
  const Eigen::Vector3d rho = natural_scale(contact);
  if (!(terms.nu(0) > rho(0) * velocity(0))) {
    return contact.stiffness(0) > 0 ? ContactMode::adhering : ContactMode::open;
  }
  const Eigen::Vector2d aim = terms.nu.tail<2>() - rho.tail<2>().cwiseProduct(velocity.tail<2>());
  const bool is_cone = options.law == FrictionLaw::cone;
  const bool sticks =
      is_cone ? aim.norm() <= terms.radius(0) : (aim.array().abs() <= terms.radius.array()).all();
  return sticks && contact.friction > 0 ? ContactMode::stick : ContactMode::slide;
}
}  // namespace

ContactModes contact_modes(const ContactProblem& problem,
                           const ContactSolution& solution,
                           const ContactOptions& options) {
  const BlockResiduals blocks = residuals_of(problem, solution, options);
  ContactModes modes;
  const std::size_t contacts = problem.friction.size();
  for (std::size_t c = 0; c < blocks.contacts.size(); ++c) {
    if (c >= contacts) {
      const bool is_rolling = blocks.contacts[c].kind == ContactKind::rolling;
      (is_rolling ? modes.rolling_residual : modes.bilateral_residual).push_back(blocks.share[c]);
      continue;
    }
    const auto row = 3 * static_cast<Eigen::Index>(c);
    modes.mode.push_back(mode_of(blocks.contacts[c], blocks.impulse.segment<3>(row),
                                 blocks.velocity.segment<3>(row), options));
    modes.residual.push_back(blocks.share[c]);
  }
  return modes;
}

}  // namespace tetwarp
