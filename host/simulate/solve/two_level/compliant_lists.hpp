/// @file compliant_lists.hpp
/// The bodies of a two-level iteration, and their rows.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "kernels/contact/compliant_body.hpp"

namespace tetwarp {

struct CompliantLists {
  std::int64_t version = 0;                 ///< differs from that of all other lists of the process
  std::vector<CompliantBody> bodies;        ///< without inverses, nodes and contacts
  std::vector<std::int32_t> model_body;     ///< [frames] elastic bodies, numbers of the model
  std::vector<std::int32_t> body_of_row;    ///< [rows]
  std::vector<std::int32_t> system_row;     ///< [rows]
  std::vector<std::int32_t> model_block;    ///< [rows]
  std::vector<std::int32_t> diagonal_rows;  ///< first system rows of the bodies by D^-1
  std::vector<std::int32_t> row_of_block;   ///< [block_count], or -1

  const CompliantBody& body_at(std::int64_t row) const {
    return bodies[static_cast<std::size_t>(body_of_row[static_cast<std::size_t>(row)])];
  }
  /// Whether A couples any body with others: then M^-1 may be far below A^-1.
  bool has_joined() const {
    return std::any_of(bodies.begin(), bodies.end(),
                       [](const CompliantBody& body) { return body.is_joined; });
  }
  std::int64_t row_count() const { return static_cast<std::int64_t>(body_of_row.size()); }
};

}  // namespace tetwarp
