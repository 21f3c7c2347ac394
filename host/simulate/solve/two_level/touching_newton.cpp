/// @file touching_newton.cpp
/// Linear laws, directions, and how far to follow them.
#include "host/simulate/solve/two_level/touching_newton.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/index_of.hpp"
#include "kernels/contact/contact_residual.hpp"
#include "kernels/contact/contact_tangent.hpp"

namespace tetwarp {
namespace {

constexpr double first_softness = 1e-2, least_softness = 1e-8, most_softness = 1;

}  // namespace

bool TouchingNewton::set(const StepSystem& system,
                         const CompliantLists& lists,
                         std::int64_t most_operations) {
  for (std::size_t c = 0; c < index_of(blocks_.count()); ++c) {
    if (blocks_.law(c).friction > 0) return false;
  }
  softness_ = first_softness;
  errors_.clear();
  return matrix_.set(system, lists, blocks_, most_operations);
}

void TouchingNewton::linearize(const std::vector<double>& impulse,
                               const std::vector<double>& velocity) {
  slope_.assign(3 * impulse.size(), 0.0);
  offset_.resize(impulse.size());
  for (std::size_t c = 0; c < impulse.size() / 3; ++c) {
    const ContactConstants<double>& law = blocks_.law(c);
    const ContactTangent own = ContactTangentOp{softness_}(
        law, normal_weight(law), impulse.data() + 3 * c, velocity.data() + 3 * c);
    std::copy_n(own.offset, 3, offset_.data() + 3 * c);
    slope_[9 * c] = own.slope + law.normal_spring;
    for (std::size_t a = 1; a < 3; ++a) slope_[9 * c + 4 * a] = law.tangent_spring;
  }
}

/// Sets the changes of v, u and r. @pre the matrix is factorized
void TouchingNewton::find_direction(const std::vector<double>& defect,
                                    const std::vector<double>& x,
                                    const std::vector<double>& velocity) {
  const std::size_t numbers = offset_.size();
  change_ = defect;
  for (double& value : offset_) value = -value;
  blocks_.add_pushes(offset_.data(), change_.data());
  matrix_.solve(change_);
  trial_impulse_ = x;
  for (std::size_t i = 0; i < x.size(); ++i) trial_impulse_[i] += change_[i];
  velocity_change_.resize(numbers);
  blocks_.velocities_of_rows(trial_impulse_, velocity_change_);
  impulse_change_ = offset_;
  for (std::size_t i = 0; i < numbers; ++i) velocity_change_[i] -= velocity[i];
  for (std::size_t c = 0; c < numbers / 3; ++c) {
    for (std::size_t e = 0; e < 9; ++e) {
      impulse_change_[3 * c + e / 3] -= slope_[9 * c + e] * velocity_change_[3 * c + e % 3];
    }
  }
}

/// The largest part of the direction that makes the error smaller, or 0.
double TouchingNewton::accepted_part(const CoupledError& error,
                                     const std::vector<double>& impulse,
                                     const std::vector<double>& velocity) {
  const double largest = *std::ranges::max_element(errors_);
  trial_impulse_.resize(impulse.size());
  trial_velocity_.resize(impulse.size());
  for (const double part : {1.0, 0.5, 0.25, 0.1}) {
    for (std::size_t i = 0; i < impulse.size(); ++i) {
      trial_impulse_[i] = impulse[i] + part * impulse_change_[i];
      trial_velocity_[i] = velocity[i] + part * velocity_change_[i];
    }
    const TouchingSums sums = blocks_.measure(switches_, trial_impulse_.data(),
                                              trial_velocity_.data(), velocity.data(), working_);
    const double laws = CoupledError::of(0, sums.natural, 0).laws;
    const double total = std::hypot((1 - part) * error.equations, laws);
    if (total <= (1 - 0.1 * part) * largest) return part;
  }
  return 0;
}

bool TouchingNewton::step(const StepSystem& system,
                          const std::vector<double>& defect,
                          const CoupledError& error,
                          std::vector<double>& x,
                          std::vector<double>& impulse,
                          std::vector<double>& velocity) {
  if (errors_.size() == errors_kept) errors_.erase(errors_.begin());
  errors_.push_back(error.total);
  for (; softness_ <= most_softness; softness_ *= 10) {
    linearize(impulse, velocity);
    if (!matrix_.factor(system, slope_)) continue;
    find_direction(defect, x, velocity);
    const double part = accepted_part(error, impulse, velocity);
    if (part == 0) continue;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += part * change_[i];
    for (std::size_t i = 0; i < impulse.size(); ++i) impulse[i] += part * impulse_change_[i];
    if (part == 1) softness_ = std::max(softness_ / 5, least_softness);
    return true;
  }
  return false;
}

}  // namespace tetwarp
