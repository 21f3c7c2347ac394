/// @file mesh_nodes.hpp
/// The parts of a mesh that are the same in all steps, in the memory of an executor.
#pragma once
#include <cstdint>

#include "host/base/warp_backend.hpp"
#include "host/warp/geometry.hpp"
#include "kernels/base/hex_view.hpp"
#include "kernels/base/view.hpp"

namespace tetwarp {

/// Uploads a plan's mesh once.
template <class Exec>
class WarpMesh {
 public:
  /// The arguments must outlive the object: a cpu executor reads their memory in place.
  WarpMesh(Exec& exec, const WarpPlan& plan, const WarpGeometry& geometry) {
    const auto tet_count = static_cast<std::int64_t>(plan.mesh.tets.size());
    const auto hex_count = static_cast<std::int64_t>(plan.mesh.hexes.size());
    const auto node_count = static_cast<std::int64_t>(geometry.rest.size());
    const auto upload = [&](const auto* data, std::int64_t count, auto& buffer) {
      return exec.resident("warp/upload", data, count, buffer);
    };
    tets = upload(plan.mesh.tets.front().data(), 4 * tet_count, tet_buffer_);
    rest = upload(geometry.rest.data(), node_count, rest_buffer_);
    orientation = upload(geometry.rest_orientation.data(), tet_count, orientation_buffer_);
    if (hex_count == 0) return;
    hexes = {upload(plan.mesh.hexes.front().data(), 8 * hex_count, hex_buffer_),
             tet_count - tets_per_hex * hex_count};
  }

  std::int64_t tet_count() const { return orientation.size; }
  std::int64_t node_count() const { return rest.size; }

  View<const std::int32_t> tets;        ///< [4 * tet_count]
  View<const Node> rest;                ///< in the source's index space [quantum]
  View<const std::int8_t> orientation;  ///< sign of the rest volume [tet_count]
  HexView hexes;

 private:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;
  Buffer<std::int32_t> tet_buffer_;
  Buffer<Node> rest_buffer_;
  Buffer<std::int8_t> orientation_buffer_;
  Buffer<std::int32_t> hex_buffer_;
};

}  // namespace tetwarp
