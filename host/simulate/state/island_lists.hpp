/// @file island_lists.hpp
/// IslandLists: bodies, blocks, springs and sizes of coupling islands.
#pragma once
#include <cstdint>
#include <vector>

#include "host/scene/scene_geometry.hpp"
#include "host/simulate/model/model.hpp"

namespace tetwarp {

/// Does not change during a simulation.
class IslandLists {
 public:
  struct Island {
    std::vector<std::int32_t> bodies;
    std::vector<std::int32_t> blocks;   ///< with unknowns
    std::vector<std::int32_t> driven;   ///< prescribed blocks of its bodies and of what it is
                                        ///< coupled to, ascending
    std::vector<std::int32_t> springs;  ///< of handles
    double size = 0;                    ///< of its smallest body [m]
  };

  IslandLists(const Scene& scene, const SceneGeometry& geometry, const Model& model);

  const std::vector<Island>& islands() const { return islands_; }
  /// Number of bodies and obstacles.
  std::size_t body_count() const { return body_driven_.size(); }
  /// Island of a body or obstacle, -1: it has no unknowns.
  std::int32_t island_of(std::int32_t body) const { return model_.island_of(body); }
  /// Prescribed blocks of a body or obstacle.
  const std::vector<std::int32_t>& driven_of(std::size_t body) const { return body_driven_[body]; }
  std::size_t block_count() const { return block_body_.size(); }
  /// The rigid body whose angular velocity a block is, -1: of another block.
  std::int32_t turning_frame(std::int32_t block) const;
  /// Position of a node, or of the center of mass of a rigid body. @pre turning_frame(block) is -1
  const Point3& place_of(std::int32_t block, const ModelState& state) const;
  /// Diagonal of the box of the body of a block at the start [m]; of obstacles 0.
  double size_of(std::int32_t block) const;

 private:
  void list_bodies(const Scene& scene, const SceneGeometry& geometry);
  void list_frames();
  void list_blocks();
  void list_springs();
  void add_driven(const ModelPoint& point, Island& island) const;

  const Model& model_;
  std::vector<Island> islands_;
  std::vector<std::vector<std::int32_t>> body_driven_;  ///< [bodies, then obstacles]
  std::vector<std::int32_t> block_body_;                ///< [blocks] body or obstacle, or -1
  std::vector<double> body_size_;                       ///< [bodies, then obstacles] [m]
};

}  // namespace tetwarp
