/// @file cage_pose.hpp
/// An elastic body whose nodes follow the vertices of a cage.
#pragma once
#include <cstdint>
#include <vector>

#include "host/scene/shapes/cage.hpp"
#include "host/simulate/start/start_shrink.hpp"

namespace tetwarp {

class CagePose {
 public:
  /// Makes a cage at the shrunk pose with at most 3 boxes along the longest axis of the body's box,
  /// and in proportion along the others.
  CagePose(const StartParts& parts, const Model& model, const ShrunkBody& shrunk);

  std::int32_t body() const { return body_; }
  std::size_t vertex_count() const { return target_.size(); }
  double size() const { return size_; }  ///< diagonal of the box at full size [m]

  /// World positions of the vertices now and at full size.
  std::vector<Point3>& vertices() { return vertices_; }
  const std::vector<Point3>& vertices() const { return vertices_; }
  const std::vector<Point3>& target() const { return target_; }

  bool has_node(std::int32_t node) const { return node >= first_ && node < end_; }
  /// Adds factor times the weights of the cage's vertices at a node of the model.
  void add_weights(std::int32_t node, double factor, std::vector<double>& weights) const;

  /// Positions of the body's nodes when the cage's vertices are at vertices() + fraction move.
  void place_nodes(const std::vector<Point3>& move, double fraction, ModelState& state) const;
  /// The smallest volume of an element over its volume at rest; negative: inverted.
  double least_volume(const Model& model, const ModelState& state) const;

 private:
  std::int32_t body_, first_, end_;  ///< body and its nodes in the model
  double size_ = 0;
  CageWeights cage_;
  std::vector<Point3> target_, vertices_;
  std::vector<std::int32_t> tets_;  ///< of the model
};

}  // namespace tetwarp
