/// @file compliant_list_maker.hpp
/// Makes CompliantLists from coupling islands.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/solve/problem/contact_islands.hpp"
#include "host/simulate/solve/two_level/compliant_lists.hpp"
#include "kernels/body/system_lists.hpp"

namespace tetwarp {

/// Keeps the lists while the same islands are taken.
class CompliantListMaker {
 public:
  /// @param body_of     [coupling islands] elastic body that gives way by its inverse at rest, or
  /// -1
  /// @param relaxation  omega
  CompliantListMaker(std::vector<std::int32_t> body_of, double relaxation);

  /// @param rows   of the system, in memory of the host
  /// @param takes  [coupling islands] which are taken
  /// @param bare   [coupling islands] 1: by diagonal blocks, whatever there is; or empty
  void make(const SystemRows& rows,
            const ContactIslands& islands,
            const std::vector<std::uint8_t>& takes,
            const std::vector<std::uint8_t>& bare = {});
  const CompliantLists& lists() const { return lists_; }
  /// Whether the body of an island gives way by its inverse.
  bool has_inverse(std::size_t island) const { return body_of_[island] >= 0; }

 private:
  bool is_made(const SystemRows& rows,
               const std::vector<std::uint8_t>& takes,
               const std::vector<std::uint8_t>& bare) const;

  std::vector<std::int32_t> body_of_;
  double relaxation_;
  std::vector<std::uint8_t> takes_, bare_;  ///< of the present lists
  std::vector<std::int32_t> block_of_;      ///< of the system
  CompliantLists lists_;
};

}  // namespace tetwarp
