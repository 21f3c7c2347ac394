/// @file problem_rows.hpp
/// The numbers of the contact problem of a step: J from the arms of contacts, A and b from the
/// system of the step.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"

namespace tetwarp {

/// How the relative velocity of a contact depends on a node or a frame: weight v + omega x lever.
struct ContactArm {
  double weight = 0;
  double lever[3] = {0, 0, 0};  ///< [m]; of nodes 0
};

/// Places of the numbers of J of an arm.
struct ArmPlace {
  std::int32_t contact = 0;
  std::int32_t first = 0;    ///< of its 3 numbers in the first row of the contact
  std::int32_t stride = 0;   ///< from a row of the contact to the next
  std::int32_t angular = 0;  ///< of a frame: from its numbers of v to those of omega; of a node: 0

  bool operator==(const ArmPlace&) const = default;
};

/// The numbers of J of one arm.
/// @param axes   normal, tangent 1, tangent 2 of its contact
/// @param first  out: place of the 3 numbers in the first row of the contact
TETWARP_HD void set_arm_rows(const double* axes,
                             const ContactArm& arm,
                             std::int32_t stride,
                             std::int32_t angular,
                             double* first) {
  const double* const lever = arm.lever;
  for (int k = 0; k < 3; ++k) {
    const double* const axis = axes + 3 * k;
    double* const out = first + std::int64_t{k} * stride;
    for (int i = 0; i < 3; ++i) out[i] = arm.weight * axis[i];
    if (angular == 0) continue;
    double* const turning = out + angular;
    turning[0] = lever[1] * axis[2] - lever[2] * axis[1];
    turning[1] = lever[2] * axis[0] - lever[0] * axis[2];
    turning[2] = lever[0] * axis[1] - lever[1] * axis[0];
  }
}

/// One index = one arm. Writes its own numbers; any order.
struct ContactRowsOp {
  View<const double> axes;  ///< [contacts][9] normal, tangent 1, tangent 2
  View<const ContactArm> arms;
  View<const ArmPlace> places;
  View<double> jacobian;  ///< out

  TETWARP_HD void operator()(std::int64_t a) const {
    const ArmPlace& place = places[a];
    set_arm_rows(axes.data + 9 * std::int64_t{place.contact}, arms[a], place.stride, place.angular,
                 jacobian.data + place.first);
  }
};

/// The place in A of a 3x3 block of the system of a step.
struct SystemBlockPlace {
  std::int32_t place = 0;   ///< in the system
  std::int32_t stride = 0;  ///< from a row of A to the next
  std::int64_t first = 0;   ///< of the 3 numbers of the first row
};

/// One index = one block, stored column by column in the system and by rows in A.
struct SystemGatherOp {
  View<const SystemBlockPlace> places;
  View<const double> values;  ///< [places of the system][9]
  View<double> out;

  TETWARP_HD void operator()(std::int64_t b) const {
    const SystemBlockPlace& of = places[b];
    const double* const block = values.data + 9 * std::int64_t{of.place};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        out[of.first + std::int64_t{i} * of.stride + j] = block[3 * j + i];
      }
    }
  }
};

/// One index = one item: copies 3 numbers, from those of `item` or to them.
struct GatherThreeOp {
  View<const std::int32_t> item;
  View<const double> from;
  View<double> to;

  TETWARP_HD void operator()(std::int64_t i) const {
    for (int k = 0; k < 3; ++k) to[3 * i + k] = from[3 * std::int64_t{item[i]} + k];
  }
};
struct ScatterThreeOp {
  View<const std::int32_t> item;
  View<const double> from;
  View<double> to;

  TETWARP_HD void operator()(std::int64_t i) const {
    for (int k = 0; k < 3; ++k) to[3 * std::int64_t{item[i]} + k] = from[3 * i + k];
  }
};

}  // namespace tetwarp
