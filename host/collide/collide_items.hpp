/// @file collide_items.hpp
/// The items of a scene's surfaces, and which features each of them owns.
#pragma once
#include <cstdint>
#include <vector>

#include "host/collide/collision_surfaces.hpp"
#include "kernels/collide/collide_item.hpp"
#include "kernels/collide/vertex_box.hpp"

namespace tetwarp {

struct CollideItems {
  std::vector<CollideItem> items;  ///< body by body
  std::vector<CollideBody> bodies;
  std::vector<std::int32_t> forbidden;  ///< second bodies of forbidden pairs, by the first
  std::vector<VertexRun> runs;  ///< body by body: of vertices; of boxes of successive runs, until
                                ///< each body has one
  std::vector<std::int64_t> levels;  ///< first run of vertices, of boxes, ..., end
  std::int64_t flat_edges = 0;       ///< edges that no item owns, as they lie within flat faces

  /// Bodies and forbidden pairs, for CollideView::may_touch() on the host; the rest is empty.
  CollideView view_of_bodies() const;
};

/// @param skips_flat_edges  false: they are owned as all others
/// @throws std::invalid_argument  one line: a vertex, edge or body outside its range, a triangle
///         whose edge is not in the list, more than 2^31 - 1 items
CollideItems make_collide_items(const CollisionSurfaces& surfaces, bool skips_flat_edges = true);

}  // namespace tetwarp
