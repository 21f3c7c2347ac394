/// @file contact_stages.hpp
/// A contact problem in the order of its structure, as the input of the solver's stages.
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/structure/structure.hpp"
#include "host/contact/structure/system.hpp"

namespace tetwarp::test {

/// All contacts are one island.
struct ContactStages {
  explicit ContactStages(const ContactProblem& problem, const ContactOptions& options = {})
      : structure(make_structure(problem, {.converged_islands = false})) {
    ContactSavings savings;
    fill_system(problem, options, structure, system, savings);
  }

  const ContactIsland& island() const { return structure.islands.front(); }
  ContactNumbers<double> numbers() const { return system.numbers(structure.indices()); }
  View<const std::int64_t> colors() const {
    return {structure.color_start.data() + island().color_begin,
            island().color_end - island().color_begin};
  }

  ContactStructure structure;
  ContactSystem<double> system;
};

/// The last index first.
struct ReversedExec {
  template <class Op>
  void for_each(const char*, std::int64_t count, const Op& op) const {
    for (std::int64_t i = count; i-- > 0;) op(i);
  }
  template <class Sum, class Op>
  Sum sum(const char*, std::int64_t first, std::int64_t last, const Op& op) const {
    Sum sum{};
    for (std::int64_t i = last; i-- > first;) sum += op(i);
    return sum;
  }
};

/// Values of the problem, `width` at each item, taken to the places that hold them.
inline std::vector<double> placed(const std::vector<double>& values,
                                  const std::vector<std::int32_t>& item_of_place,
                                  std::size_t width) {
  std::vector<double> result;
  for (const std::int32_t item : item_of_place) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(width) * item;
    result.insert(result.end(), first, first + static_cast<std::ptrdiff_t>(width));
  }
  return result;
}

/// Largest difference of two lists over the largest entry of the second.
inline double relative_distance(const std::vector<double>& a, const std::vector<double>& b) {
  using Values = Eigen::Map<const Eigen::VectorXd>;
  const auto size = static_cast<Eigen::Index>(b.size());
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  if (size == 0) return 0;
  const Values left(a.data(), size), right(b.data(), size);
  return (left - right).lpNorm<Eigen::Infinity>() / right.lpNorm<Eigen::Infinity>();
}

}  // namespace tetwarp::test
