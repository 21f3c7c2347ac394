/// @file residual_check.cpp
/// Conjugate gradients on the defect, and the bound of eta.
#include "host/simulate/solve/two_level/residual_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "host/base/index_of.hpp"
#include "host/base/vector_view.hpp"
#include "kernels/contact/contact_bound.hpp"

namespace tetwarp {
namespace {

// The way to the solution, squared in the norm of A, is at least the sum of those of all steps.
// Iterations end where the last few were at most this part of it.
constexpr double least_gain = 0.04;
// No iterations where the defect in the norm of M^-1 is at most this part of the tolerance, as
// after steps of Newton's method: A^-1 is hardly more than a million times M^-1.
constexpr double least_share = 1e-4;
constexpr std::ptrdiff_t few = 4;
constexpr int most_iterations = 1000, asked_after = 10;

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

}  // namespace

void ResidualCheck::set(const CompliantLists& lists, const std::vector<double>& free) {
  lists_ = &lists;
  free_ = &free;
  is_needed_ =
      std::ranges::any_of(lists.bodies, [](const CompliantBody& body) { return body.is_joined; });
  if (!is_needed_) return;
  lower_.resize(index_of(blocks_.count()));
  for (std::size_t c = 0; c < lower_.size(); ++c) find_lower(c);
  zeros_.assign(3 * index_of(std::max(lists.row_count(), blocks_.count())), 0.0);
}

/// All of A^-1 is at least M^-1 over the largest eigenvalue of M^-1 A: with omega D^-1 below 2, and
/// of a single block below omega; with factors at rest about 1.
void ResidualCheck::find_lower(std::size_t contact) {
  lower_[contact] = blocks_.law(contact);
  const std::int32_t count = blocks_.block_start()[contact + 1] - blocks_.block_start()[contact];
  double factor = 1;
  blocks_.for_blocks(contact, [&](std::size_t b) {
    const CompliantBody& own = lists_->body_at(blocks_.row()[b]);
    if (own.frame < 0 && own.relaxation != 1) {
      factor = std::min(factor, count == 1 ? 1 / own.relaxation : 0.5);
    }
  });
  for (double& entry : lower_[contact].block) entry *= factor;
  lower_[contact].tangent_metric *= factor;
}

/// One run of the step gives A p and M^-1 A p. @returns whether the velocities are found
bool ResidualCheck::find_consistent(const std::vector<double>& x,
                                    const std::vector<double>& stepped,
                                    double negligible,
                                    const std::function<bool()>& goes_on) {
  const std::size_t size = x.size();
  solution_ = x;
  defect_ = step_.defect();
  defect_.resize(size);
  preconditioned_.resize(size);
  for (std::size_t i = 0; i < size; ++i) preconditioned_[i] = stepped[i] - x[i];
  direction_ = preconditioned_;
  image_.resize(stepped.size());
  gains_.clear();
  double square = dot(defect_, preconditioned_), moved = 0;
  for (int k = 0; k < most_iterations; ++k) {
    if (square <= negligible) return true;
    if (k % asked_after == asked_after - 1 && !goes_on()) return false;
    step_.run(direction_, zeros_, image_);
    const double curvature = -dot(direction_, step_.defect());
    if (!(curvature > 0)) return std::isfinite(square);  // what is left is rounding
    const double length = square / curvature;
    for (std::size_t i = 0; i < size; ++i) {
      solution_[i] += length * direction_[i];
      defect_[i] += length * step_.defect()[i];
      preconditioned_[i] -= length * (direction_[i] - image_[i]);
    }
    gains_.push_back(length * square);
    moved += gains_.back();
    const std::ptrdiff_t last = std::min(few, std::ssize(gains_));
    if (last == few &&
        std::accumulate(gains_.end() - last, gains_.end(), 0.0) <= least_gain * moved) {
      return true;
    }
    const double next = dot(defect_, preconditioned_), turn = next / square;
    square = next;
    for (std::size_t i = 0; i < size; ++i) {
      direction_[i] = preconditioned_[i] + turn * direction_[i];
    }
  }
  return false;
}

double ResidualCheck::eta_of(const Limits& limits,
                             const std::vector<double>& impulse,
                             const std::vector<double>& velocity) const {
  const ContactResidualOp<double> natural{view_of(lower_), switches_, view_of(impulse),
                                          view_of(velocity_), view_of(*free_)};
  const ContactResidualOp<double> alone{view_of(lower_), switches_, view_of(zeros_),
                                        view_of(*free_), view_of(*free_)};
  ContactSums sums, free;
  for (std::int64_t c = 0; c < blocks_.count(); ++c) {
    sums += ResidualBoundOp{natural, view_of(velocity)}(c);
    free += FreeResidualBoundOp{alone}(c);
  }
  if (sums.eta == 0) return 0;
  const double scale = std::sqrt(free.eta) + std::sqrt(std::max(sums.work, 0.0));
  return std::sqrt(sums.eta) / std::max(scale, limits.least_scale);
}

double ResidualCheck::run(const std::vector<double>& x,
                          const std::vector<double>& stepped,
                          const std::vector<double>& impulse,
                          const std::vector<double>& velocity,
                          const Limits& limits,
                          const std::function<bool()>& goes_on) {
  double work = 0;
  for (std::size_t i = 0; i < impulse.size(); ++i) {
    work += impulse[i] * (velocity[i] - (*free_)[i]);
  }
  const double negligible =
      square_of(least_share * limits.tolerance) * std::max(work, square_of(limits.least_scale));
  if (!find_consistent(x, stepped, negligible, goes_on)) {
    return std::numeric_limits<double>::infinity();
  }
  velocity_.resize(impulse.size());
  blocks_.velocities_of_rows(solution_.data(), velocity_.data());
  return eta_of(limits, impulse, velocity);
}

}  // namespace tetwarp
