/// @file condensed_choice.hpp
/// CondensedChoice: which contact islands are solved by the matrix of their contacts.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "host/simulate/solve/condensed/condensed_island.hpp"
#include "host/simulate/solve/problem/contact_shares.hpp"
#include "host/simulate/step/cpu/rest_factors.hpp"

namespace tetwarp {

/// Those of joined bodies and of cloth with few contacts, whose factors have few entries. Contact
/// islands of bodies that each have a factor at rest are not taken, nor those that have neither
/// friction nor elastic bodies.
///
/// Determinism: by counted multiplications.
class CondensedChoice {
 public:
  /// Of a contact island.
  struct Limits {
    std::int64_t contacts;
    std::int64_t operations;  ///< multiplications of factors, of solves for columns, and of W
  };

  /// @param islands, factors  kept by the caller
  CondensedChoice(const ContactIslands& islands, const RestFactors& factors)
      : islands_(islands), factors_(factors) {}

  /// @param places    of the islands
  /// @param coupling  [coupling islands] their patterns are found where they may be taken
  /// @param rows      J of all contacts
  /// @param laws      of all contacts
  /// @param share     what there is to take
  void find(const Limits& limits,
            const SystemRows& system,
            const SystemIslands& places,
            std::vector<CondensedIsland>& coupling,
            const ContactRows& rows,
            const ContactProblem& laws,
            const ContactShare& share);
  bool takes(std::int32_t coupling_island) const { return cost_of(coupling_island).is_taken; }

 private:
  struct Cost {
    std::int64_t contacts = 0, rows = 0, operations = 0;
    bool has_joined = false, has_elastic = false, has_friction = false, is_taken = false;
  };
  /// Of a coupling island.
  struct Touch {
    std::int64_t contacts = 0, blocks = 0;
    std::int32_t last = -1;  ///< the contact that was counted last
  };

  const Cost& cost_of(std::int32_t island) const {
    return costs_[static_cast<std::size_t>(islands_.root(island))];
  }
  Cost& cost_of(std::int32_t island) {
    return costs_[static_cast<std::size_t>(islands_.root(island))];
  }
  void find_kinds(const SystemIslands& places,
                  const ContactProblem& laws,
                  const ContactShare& share);
  void find_touches(const SystemIslands& places,
                    const ContactRows& rows,
                    const ContactShare& share);

  const ContactIslands& islands_;
  const RestFactors& factors_;
  std::vector<Cost> costs_;     ///< [coupling islands] of contact islands, set at their roots
  std::vector<Touch> touches_;  ///< [coupling islands]
};

}  // namespace tetwarp
