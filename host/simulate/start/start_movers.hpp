/// @file start_movers.hpp
/// StartMovers: what moves as a whole where bodies are pushed apart at the start.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/simulate/model/model.hpp"

namespace tetwarp {

/// At first groups of coupled bodies, those that are held nowhere; then single nodes and rigid
/// bodies. A mover has one displacement.
class StartMovers {
 public:
  /// @param model  kept by the caller
  explicit StartMovers(const Model& model);

  /// From now on nodes and rigid bodies move on their own.
  void divide();
  bool are_divided() const { return are_divided_; }

  std::int32_t count() const { return static_cast<std::int32_t>(mass_.size()); }
  double mass(std::int32_t mover) const;  ///< [kg]

  struct Share {
    std::int32_t mover = 0;
    double weight = 0;
  };
  /// Adds the movers of a point times a weight, each at most once.
  void add_shares(const ModelPoint& point, double weight, std::vector<Share>& shares) const;
  /// Moves all movers by a fraction of their ways.
  /// @param way  [movers][3] [m]
  void move(std::span<const double> way, double fraction, ModelState& state) const;

 private:
  template <class VisitNode, class VisitRigid>
  void visit_parts(const VisitNode& visit_node, const VisitRigid& visit_rigid) const;
  bool is_held(std::int64_t block) const;
  std::int64_t block_of_rigid(std::int32_t rigid) const;
  void hold_all();
  void set_islands();
  std::int32_t new_mover(double mass);
  static void add_share(std::int32_t mover, double weight, std::vector<Share>& shares);

  const Model& model_;
  bool are_divided_ = false;
  std::vector<std::int32_t> of_node_, of_rigid_;  ///< -1: does not move
  std::vector<double> mass_;
};

}  // namespace tetwarp
