/// @file row_solution.cpp
/// Impulses and velocities of a problem from those of its blocks, and the other way round.
#include <iterator>
#include <stdexcept>
#include <string>

#include "host/contact/problem/row_blocks.hpp"
#include "host/contact/problem/row_parts.hpp"

namespace tetwarp {
namespace {
void check_length(const char* name, std::size_t size, std::size_t expected) {
  if (size == expected) return;
  throw std::invalid_argument(std::string(name) + ": " + std::to_string(size) +
                              " entries, expected " + std::to_string(expected));
}
}  // namespace

void BlockProblem::set_solution(std::span<const double> impulse,
                                std::span<const double> body_velocity,
                                ContactSolution& solution) const {
  const std::size_t contacts = given_.friction.size();
  std::size_t block = 3 * contacts;
  solution.impulse.assign(impulse.begin(), impulse.begin() + static_cast<std::ptrdiff_t>(block));
  for (std::size_t i = 0; i < scale_.size(); ++i)
    solution.impulse[i / 2 * 3 + i % 2 + 1] *= scale_[i];
  solution.bilateral_impulse.clear();
  if (!given_.bilateral.empty()) {
    const std::vector<std::int32_t> starts = group_starts(given_.bilateral);
    for (std::size_t g = 0; g + 1 < starts.size(); ++g, block += 3) {
      for (std::int32_t row = starts[g]; row < starts[g + 1]; ++row) {
        solution.bilateral_impulse.push_back(impulse[block + index_of(row - starts[g])]);
      }
    }
  }
  const auto rolling = impulse.begin() + static_cast<std::ptrdiff_t>(block);
  solution.rolling_impulse.assign(rolling, rolling + 3 * std::ssize(given_.rolling.contact));
  block += 3 * given_.rolling.contact.size();
  for (const std::int32_t c : sprung_) {
    for (std::size_t a = 0; a < 2; ++a)
      solution.impulse[3 * index_of(c) + 1 + a] += impulse[block + a];
    block += 3;
  }
  solution.body_velocity.assign(body_velocity.begin(), body_velocity.begin() + given_.dof_count());
}

std::vector<double> BlockProblem::impulse_of(const ContactSolution& solution) const {
  const std::size_t contacts = given_.friction.size();
  check_length("impulse", solution.impulse.size(), 3 * contacts);
  check_length("bilateral_impulse", solution.bilateral_impulse.size(),
               index_of(given_.bilateral.row_count()));
  check_length("rolling_impulse", solution.rolling_impulse.size(),
               3 * given_.rolling.contact.size());
  std::vector<double> impulse = solution.impulse;
  if (!given_.bilateral.empty()) {
    const std::vector<std::int32_t> starts = group_starts(given_.bilateral);
    for (std::size_t g = 0; g + 1 < starts.size(); ++g) {
      for (std::int32_t row = starts[g]; row < starts[g] + 3; ++row) {
        impulse.push_back(row < starts[g + 1] ? solution.bilateral_impulse[index_of(row)] : 0.0);
      }
    }
  }
  impulse.insert(impulse.end(), solution.rolling_impulse.begin(), solution.rolling_impulse.end());
  for (const std::int32_t c : sprung_) {
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t row = 3 * index_of(c) + 1 + a;
      double spring = 0;
      if (a < 2 && !solution.velocity.empty()) {
        const double stretch = entry_of(given_.adhesion.gap, row) / given_.adhesion.time_step;
        spring = -tangent_spring(given_.adhesion, index_of(c)) * (solution.velocity[row] + stretch);
        impulse[row] -= spring;
      }
      impulse.push_back(spring);
    }
  }
  for (std::size_t i = 0; i < scale_.size(); ++i) {
    // Without friction along a tangent its row is empty, and any impulse there an error.
    double& r = impulse[i / 2 * 3 + i % 2 + 1];
    r = scale_[i] > 0 ? r / scale_[i] : 0.0;
  }
  return impulse;
}

std::vector<double> BlockProblem::body_velocity_of(const ContactSolution& solution,
                                                   std::span<const double> impulse) const {
  check_length("body_velocity", solution.body_velocity.size(), index_of(given_.dof_count()));
  std::vector<double> v = solution.body_velocity;
  for (std::size_t i = 0; i < compliance_.size(); ++i) {
    v.push_back(compliance_[i] * impulse[index_of(row_of_dof_[i])]);
  }
  return v;
}

}  // namespace tetwarp
