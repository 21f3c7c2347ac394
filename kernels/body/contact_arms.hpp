/// @file contact_arms.hpp
/// The nodes and frames that the two points of a contact move with, and its arms.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/body/problem_rows.hpp"

namespace tetwarp {

/// The point of a contact on one body: a point of a frame, or a weighted mean of up to three
/// vertices of surfaces. With neither it does not move.
struct ContactSide {
  std::int32_t frame = -1;
  std::int32_t vertex[3] = {-1, -1, -1};  ///< of all surfaces; -1: not used
  double weight[3] = {0, 0, 0};           ///< of the vertices
  double point[3] = {0, 0, 0};            ///< world, at the start of the step [m]
};

struct ContactSides {
  double axes[9];    ///< normal, tangent 1, tangent 2
  ContactSide a, b;  ///< the velocity of the contact is that of a less that of b
};

struct BlockArm {
  std::int32_t block = 0;  ///< of the model; of a frame the first one
  ContactArm arm;
};

/// The arms of a contact, sorted by block; each block once.
class ArmList {
 public:
  TETWARP_HD void clear() { size_ = 0; }
  TETWARP_HD int size() const { return size_; }
  TETWARP_HD const BlockArm& operator[](int i) const { return arms_[i]; }

  /// The arm of a block; adds one if there is none.
  TETWARP_HD ContactArm& of(std::int32_t block) {
    int i = size_;
    while (i > 0 && arms_[i - 1].block > block) --i;
    if (i > 0 && arms_[i - 1].block == block) return arms_[i - 1].arm;
    for (int k = size_; k > i; --k) arms_[k] = arms_[k - 1];
    ++size_;
    arms_[i] = {block, {}};
    return arms_[i].arm;
  }

 private:
  static constexpr int most = 24;  ///< two sides of three vertices of four nodes

  int size_ = 0;
  BlockArm arms_[most];
};

/// Finds the arms of contacts at the start of a step.
/// @tparam Point  SurfacePoint or ModelPoint
template <class Point>
struct ArmFinder {
  View<const Point> points;   ///< [vertices] what each is bound to
  View<const double> center;  ///< of frames, [frames][3]
  std::int32_t node_count;    ///< of the model, whose next blocks are those of the frames

  /// @param arms  out
  TETWARP_HD void find(const ContactSides& contact, ArmList& arms) const {
    arms.clear();
    add_side(contact.a, 1, arms);
    add_side(contact.b, -1, arms);
  }

 private:
  TETWARP_HD void add_side(const ContactSide& side, double sign, ArmList& arms) const {
    if (side.frame >= 0) return add_frame(side.frame, side.point, sign, arms);
    for (int k = 0; k < 3; ++k) {
      if (side.vertex[k] < 0) continue;
      const Point& vertex = points[side.vertex[k]];
      const double weight = sign * side.weight[k];
      if (vertex.rigid >= 0) {
        add_frame(vertex.rigid, side.point, weight, arms);
        continue;
      }
      for (int n = 0; n < 4; ++n) {
        if (vertex.node[n] >= 0) arms.of(vertex.node[n]).weight += weight * vertex.weight[n];
      }
    }
  }
  TETWARP_HD void add_frame(std::int32_t frame,
                            const double* point,
                            double weight,
                            ArmList& arms) const {
    ContactArm& arm = arms.of(node_count + 2 * frame);
    arm.weight += weight;
    for (int i = 0; i < 3; ++i) {
      arm.lever[i] += weight * (point[i] - center[3 * std::int64_t{frame} + i]);
    }
  }
};

}  // namespace tetwarp
