/// @file contact_groups.hpp
/// Contacts in groups of the same one or two compliant bodies, and the dense matrices by which the
/// impulses of a group act on each other and on the nodes of its bodies.
#pragma once
#include <cstdint>

#include "kernels/elastic/touching_rows.hpp"

namespace tetwarp {

/// Contacts [contact_begin, contact_end), all between the same bodies.
struct ContactGroup {
  std::int32_t contact_begin = 0, contact_end = 0;
  std::int32_t body[2] = {-1, -1};  ///< -1: none, what does not move
  std::int32_t node_count = 0;      ///< of both bodies, one after the other
  std::int32_t passes = 1;          ///< over its contacts in a sweep
  std::int64_t units = 0;           ///< first of its node velocities for unit impulses
  std::int64_t matrix = 0;          ///< first number of its matrix

  TETWARP_HD std::int64_t contact_count() const { return contact_end - contact_begin; }
};

struct ContactGroups {
  CompliantBodies bodies;
  TouchingRows touching;
  View<const ContactGroup> groups;
  View<const std::int32_t> group_of_contact;
  View<const double> turned;  ///< J in frames, [blocks][9]

  TETWARP_HD const ContactGroup& of_contact(std::int64_t contact) const {
    return groups[group_of_contact[contact]];
  }
  /// The node at a place among those of a group.
  TETWARP_HD std::int64_t node_at(const ContactGroup& group, std::int64_t place) const {
    const CompliantBody& first = bodies.bodies[group.body[0]];
    if (place < first.node_count) return first.first_node + place;
    return bodies.bodies[group.body[1]].first_node + place - first.node_count;
  }
  TETWARP_HD std::int64_t place_of(const ContactGroup& group, std::int64_t node) const {
    const CompliantBody& first = bodies.bodies[group.body[0]];
    const std::int64_t place = node - first.first_node;
    if (place >= 0 && place < first.node_count) return place;
    return first.node_count + node - bodies.bodies[group.body[1]].first_node;
  }
};

/// One index = one block of J: turns it.
struct TurnJacobianBody {
  CompliantBodies of;
  TouchingRows touching;
  View<double> turned;  ///< out

  TETWARP_HD void operator()(std::int64_t block) const {
    const CompliantBody& own = of.of_row(touching.row[block]);
    for (int a = 0; a < 3; ++a) {
      own.to_frame(touching.jacobian.data + 9 * block + 3 * a, turned.data + 9 * block + 3 * a);
    }
  }
};

/// (contact, place, item): velocities of the node at a place of the contact's group for unit
/// impulses of the contact. Three rows per contact, each of all nodes of the group.
struct UnitVelocityBody {
  ContactGroups of;
  View<float> units;  ///< out

  TETWARP_HD void operator()(std::int64_t contact, std::int64_t place, std::int64_t) const {
    const ContactGroup& group = of.of_contact(contact);
    const std::int64_t row = of.bodies.row_of_node[of.node_at(group, place)];
    const std::int32_t body = of.bodies.body_of_row[row];
    double sum[9] = {};
    const TouchingRows& touching = of.touching;
    for (std::int64_t b = touching.block_start[contact]; b < touching.block_start[contact + 1];
         ++b) {
      if (of.bodies.body_of_row[touching.row[b]] != body) continue;
      double c[9];
      of.bodies.block(row, touching.row[b], c);
      const double* const j = of.turned.data + 9 * b;
      for (int a = 0; a < 3; ++a) {
        for (int i = 0; i < 3; ++i) {
          sum[3 * a + i] +=
              c[3 * i] * j[3 * a] + c[3 * i + 1] * j[3 * a + 1] + c[3 * i + 2] * j[3 * a + 2];
        }
      }
    }
    const std::int64_t width = 3 * std::int64_t{group.node_count};
    float* const out =
        units.data + group.units + 3 * (contact - group.contact_begin) * width + 3 * place;
    for (int a = 0; a < 3; ++a) {
      for (int i = 0; i < 3; ++i) out[a * width + i] = static_cast<float>(sum[3 * a + i]);
    }
  }
};

/// (contact, other, item): velocities of the other contact of the group, by its number there, for
/// unit impulses of the contact: its 3x3 block of J M^-1 J^T. Three rows per contact, each of all
/// contacts of the group.
struct GroupMatrixBody {
  ContactGroups of;
  View<const float> units;
  View<float> matrix;  ///< out

  TETWARP_HD void operator()(std::int64_t contact, std::int64_t other, std::int64_t) const {
    const ContactGroup& group = of.of_contact(contact);
    const std::int64_t number = contact - group.contact_begin;
    const std::int64_t width = 3 * std::int64_t{group.node_count};
    const float* const own = units.data + group.units + 3 * number * width;
    const TouchingRows& touching = of.touching;
    const std::int64_t second = group.contact_begin + other;
    double sum[9] = {};
    for (std::int64_t b = touching.block_start[second]; b < touching.block_start[second + 1]; ++b) {
      const float* const z = own + 3 * of.place_of(group, touching.node[b]);
      const double* const j = of.turned.data + 9 * b;
      for (int a = 0; a < 3; ++a) {
        for (int k = 0; k < 3; ++k) {
          for (int i = 0; i < 3; ++i) {
            sum[3 * a + k] += j[3 * k + i] * double{z[a * width + i]};
          }
        }
      }
    }
    const std::int64_t stride = 3 * group.contact_count();
    float* const out = matrix.data + group.matrix + 3 * number * stride + 3 * other;
    for (int a = 0; a < 3; ++a) {
      for (int k = 0; k < 3; ++k) out[a * stride + k] = static_cast<float>(sum[3 * a + k]);
    }
  }
};

/// One index = one contact: its own block of the matrix of its group, and what its law needs of it.
struct OwnBlockBody {
  ContactGroups of;
  View<const float> matrix;
  View<ContactConstants<double>> constants;  ///< in and out
  View<double> diagonal;                     ///< out, [3 contacts]

  TETWARP_HD void operator()(std::int64_t contact) const {
    const ContactGroup& group = of.of_contact(contact);
    const std::int64_t number = contact - group.contact_begin;
    const std::int64_t stride = 3 * group.contact_count();
    const float* const own = matrix.data + group.matrix + 3 * number * (stride + 1);
    double* const block = constants[contact].block;
    for (int a = 0; a < 3; ++a) {
      for (int k = 0; k < 3; ++k) block[3 * k + a] = own[a * stride + k];
      diagonal[3 * contact + a] = own[a * stride + a];
    }
    constants[contact].tangent_metric =
        larger_eigenvalue(block[4], (block[5] + block[7]) / 2, block[8]);
  }
};

}  // namespace tetwarp
