/// @file rest_factors.hpp
/// RestFactors: the factors at rest of all elastic bodies, for the last few lengths of a step.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "host/simulate/step/cpu/rest_factor.hpp"

namespace tetwarp {

/// Shared by the linear solve and the solution of contacts; each takes the factor of a body on one
/// thread at a time.
class RestFactors {
 public:
  /// @param model  kept by the caller
  explicit RestFactors(const Model& model);

  /// Whether a body has a factor.
  bool has(std::int32_t body) const { return has_[static_cast<std::size_t>(body)] != 0; }
  /// Whether any body of a coupling island has a factor.
  bool has_any(std::int32_t island) const {
    return has_any_[static_cast<std::size_t>(island)] != 0;
  }
  /// The bodies of a coupling island if all have factors, ascending; else none.
  const std::vector<std::int32_t>& bodies_of_island(std::int32_t island) const {
    return bodies_of_island_[static_cast<std::size_t>(island)];
  }
  /// [blocks] the body with a factor that each belongs to, or -1.
  std::vector<std::int32_t> bodies_of_blocks() const;
  /// Selects the factors for a length of the step [s].
  void set_time_step(double time_step);
  /// The factor for the selected length; made when first needed. Different bodies may be asked for
  /// by different threads.
  RestFactor& of_body(std::int32_t body);

 private:
  struct Factors {
    double time_step = 0;
    std::vector<std::unique_ptr<RestFactor>> of_body;  ///< [bodies], null: not needed yet
  };

  const Model& model_;
  std::vector<std::uint8_t> has_;                            ///< [bodies]
  std::vector<std::uint8_t> has_any_;                        ///< [coupling islands]
  std::vector<std::vector<std::int32_t>> bodies_of_island_;  ///< [coupling islands]
  std::vector<Factors> factors_;                             ///< of the last lengths
  std::size_t selected_ = 0;
};

}  // namespace tetwarp
