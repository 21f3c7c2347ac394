/// @file taken_islands.hpp
/// The coupling islands that a TwoLevelSolver takes.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/solve/problem/contact_islands.hpp"
#include "host/simulate/solve/two_level/elastic_space.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

/// The rows of a coupling island.
struct IslandRange {
  std::int32_t row_begin = 0, row_end = 0;
  bool is_coupled = true;     ///< false: a single rigid body
  std::int32_t elastic = -1;  ///< place in ElasticSpace::bodies(), or -1
};

class TakenIslands {
 public:
  /// Lists the islands that are taken.
  void set(const SystemRows& rows,
           const ContactIslands& islands,
           const std::vector<std::uint8_t>& takes,
           const ElasticSpace& elastic);

  const std::vector<IslandRange>& list() const { return islands_; }
  /// Place in list() of the island of each row with unknowns, or -1.
  std::int32_t of_row(std::int64_t row) const {
    return island_of_row_[static_cast<std::size_t>(row)];
  }

 private:
  std::vector<IslandRange> islands_;
  std::vector<std::int32_t> island_of_row_;
};

}  // namespace tetwarp
