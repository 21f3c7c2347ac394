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
  /// @param body_of     [blocks] elastic body that gives way by its inverse at rest, or -1
  /// @param relaxation  omega
  CompliantListMaker(std::vector<std::int32_t> body_of, double relaxation);

  /// @param rows   of the system, in memory of the host
  /// @param takes  [coupling islands] which are taken
  /// @param bare   [bodies of the model] 1: by diagonal blocks, whatever there is; or empty
  void make(const SystemRows& rows,
            const ContactIslands& islands,
            const std::vector<std::uint8_t>& takes,
            const std::vector<std::uint8_t>& bare = {});
  const CompliantLists& lists() const { return lists_; }
  /// [blocks] as given.
  const std::vector<std::int32_t>& body_of() const { return body_of_; }

 private:
  bool is_joined(const SystemRows& rows, std::int32_t row, std::int32_t elastic) const;
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
