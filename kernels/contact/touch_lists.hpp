/// @file touch_lists.hpp
/// Stages that make the rows and lists of contacts on compliant bodies: first counts of blocks,
/// parts and nodes, then, at places that follow from sums of these counts, the arrays of
/// TouchingNodes and the nodes of CompliantBodies.
#pragma once
#include <cstdint>

#include "kernels/base/atomic_add.hpp"
#include "kernels/base/key_value.hpp"
#include "kernels/body/contact_arms.hpp"
#include "kernels/body/surface_move.hpp"
#include "kernels/contact/compliant_body.hpp"

namespace tetwarp {

/// Contacts and the rows of a solve.
struct TouchListInput {
  View<const ContactSides> contacts;
  ArmFinder<SurfacePoint> finder;
  View<const std::int32_t> row_of_block;  ///< [blocks of the model], or -1: not in the solve
  View<const std::int32_t> body_of_row;   ///< [rows]

  /// Calls add(first row, arm, whether it is a frame) for each arm of a contact on rows of the
  /// solve, in the order of their blocks: arms on one body are successive. A frame has two rows.
  template <class Add>
  TETWARP_HD void for_arms(std::int64_t contact, const Add& add) const {
    ArmList arms;
    finder.find(contacts[contact], arms);
    for (int a = 0; a < arms.size(); ++a) {
      const std::int32_t block = arms[a].block, row = row_of_block[block];
      if (row >= 0) add(row, arms[a].arm, block >= finder.node_count);
    }
  }
};

/// Counts of blocks and parts of contacts, and of nodes. Before the scan, block_count(),
/// part_count() and is_node() (0 or 1) are the counts; after it, first_block(), first_part() and
/// first_node() are sums over all earlier entries. Each list has one more entry for its end.
struct TouchSums {
  View<std::int64_t> sums;  ///< [contacts + 1], [contacts + 1], [rows + 1]
  std::int64_t contacts;

  static std::int64_t size(std::int64_t contacts, std::int64_t rows) {
    return 2 * contacts + rows + 3;
  }
  TETWARP_HD std::int64_t& block_count(std::int64_t contact) const { return sums[contact]; }
  TETWARP_HD std::int64_t& part_count(std::int64_t contact) const {
    return sums[contacts + 1 + contact];
  }
  TETWARP_HD std::int64_t& is_node(std::int64_t row) const { return sums[2 * contacts + 2 + row]; }

  TETWARP_HD std::int64_t first_block(std::int64_t contact) const { return sums[contact]; }
  TETWARP_HD std::int64_t first_part(std::int64_t contact) const {
    return part_count(contact) - sums[contacts + 1];
  }
  TETWARP_HD std::int64_t first_node(std::int64_t row) const {
    return is_node(row) - sums[2 * contacts + 2];
  }
};

/// One index = one contact. Counts are zero before. All contacts on one row store the same number
/// 1.
struct TouchCountOp {
  TouchListInput in;
  TouchSums out;

  TETWARP_HD void operator()(std::int64_t contact) const {
    std::int64_t blocks = 0, parts = 0;
    std::int32_t last_body = -1;
    in.for_arms(contact, [&](std::int32_t row, const ContactArm&, bool is_frame) {
      const int rows = is_frame ? 2 : 1;
      for (int k = 0; k < rows; ++k) out.is_node(row + k) = 1;
      blocks += rows;
      if (in.body_of_row[row] != last_body) ++parts;
      last_body = in.body_of_row[row];
    });
    out.block_count(contact) = blocks;
    out.part_count(contact) = parts;
  }
};

/// One index = one body, or the end of the list: counts its nodes.
struct BodyNodesOp {
  TouchSums counted;
  View<CompliantBody> bodies;  ///< in, out
  View<std::int64_t> squares;  ///< out, [bodies + 1] of the numbers of nodes

  TETWARP_HD void operator()(std::int64_t b) const {
    squares[b] = 0;
    if (b == bodies.size) return;
    CompliantBody& own = bodies[b];
    const std::int64_t first = counted.first_node(own.first);
    own.first_node = static_cast<std::int32_t>(first);
    own.node_count = static_cast<std::int32_t>(counted.first_node(own.first + own.count) - first);
    own.contact_count = 0;
    squares[b] = std::int64_t{own.node_count} * own.node_count;
  }
};

struct TouchTotals {
  std::int64_t blocks, parts, nodes, node_pairs;
};
/// One index: the sizes of the lists.
struct TouchTotalsOp {
  TouchSums counted;
  std::int64_t rows;
  View<const std::int64_t> squares;  ///< sums of those of the bodies before
  TouchTotals* totals;               ///< out

  TETWARP_HD void operator()(std::int64_t) const {
    *totals = {counted.first_block(counted.contacts), counted.first_part(counted.contacts),
               counted.first_node(rows), squares[squares.size - 1]};
  }
};

/// One index = one row, or the end of the list: its node, if it is one. Pairs of nodes of one body
/// are numbered by their first node.
struct NodeListOp {
  TouchSums counted;
  View<const std::int32_t> body_of_row;
  View<const std::int64_t> squares;  ///< sums of those of the bodies before
  View<CompliantBody> bodies;        ///< in, out: their compliances
  View<std::int32_t> row_of_node;    ///< out, [nodes]
  View<std::int64_t> pair_start;     ///< out, [nodes + 1]

  TETWARP_HD void operator()(std::int64_t row) const {
    const std::int64_t node = counted.first_node(row);
    if (row == body_of_row.size) {
      pair_start[node] = squares[squares.size - 1];
      return;
    }
    const std::int32_t b = body_of_row[row];
    CompliantBody& own = bodies[b];
    if (row == own.first) own.compliance = 9 * squares[b];
    if (counted.first_node(row + 1) == node) return;
    row_of_node[node] = static_cast<std::int32_t>(row);
    pair_start[node] = squares[b] + (node - own.first_node) * own.node_count;
  }
};

/// One index = one contact, or the end of the list: its blocks and parts, with the numbers of J.
struct TouchListOp {
  TouchListInput in;
  TouchSums counted;
  View<CompliantBody> bodies;                   ///< in, out: number of contacts
  View<std::int32_t> block_start, part_start;   ///< out, [contacts + 1]
  View<std::int32_t> row, node, contact, part;  ///< out, [blocks]
  View<std::int32_t> part_block, part_body;     ///< out, [parts + 1], [parts]
  View<double> jacobian;                        ///< out, [blocks][9]
  View<KeyValue> touches;                       ///< out, [blocks] rows and blocks

  TETWARP_HD void operator()(std::int64_t c) const {
    std::int64_t next = counted.first_block(c), next_part = counted.first_part(c);
    block_start[c] = static_cast<std::int32_t>(next);
    part_start[c] = static_cast<std::int32_t>(next_part);
    if (c == counted.contacts) {
      part_block[next_part] = static_cast<std::int32_t>(next);
      return;
    }
    std::int32_t last_body = -1;
    in.for_arms(c, [&](std::int32_t first_row, const ContactArm& arm, bool is_frame) {
      const std::int32_t body = in.body_of_row[first_row];
      if (body != last_body) {
        part_block[next_part] = static_cast<std::int32_t>(next);
        part_body[next_part] = body;
        ++next_part;
        atomic_add(&bodies[body].contact_count, 1);
      }
      last_body = body;
      set_arm_rows(in.contacts[c].axes, arm, 3, is_frame ? 9 : 0, jacobian.data + 9 * next);
      for (int k = 0; k < (is_frame ? 2 : 1); ++k, ++next) {
        row[next] = first_row + k;
        node[next] = static_cast<std::int32_t>(counted.first_node(first_row + k));
        contact[next] = static_cast<std::int32_t>(c);
        part[next] = static_cast<std::int32_t>(next_part - 1);
        touches[next] = make_key_value(first_row + k, next);
      }
    });
  }
};

/// One index = one row, the end of the list of rows, or one block: lists the blocks of each row.
struct RowTouchesOp {
  View<const KeyValue> touches;    ///< sorted by row, then block
  View<std::int32_t> touch_start;  ///< out, [rows + 1]
  View<std::int32_t> touch;        ///< out, [blocks]

  TETWARP_HD void operator()(std::int64_t i) const {
    if (i < touches.size) touch[i] = value_of(touches[i]);
    if (i >= touch_start.size) return;
    std::int64_t begin = 0, end = touches.size;
    while (begin < end) {
      const std::int64_t middle = (begin + end) / 2;
      if (key_of(touches[middle]) < i) {
        begin = middle + 1;
      } else {
        end = middle;
      }
    }
    touch_start[i] = static_cast<std::int32_t>(begin);
  }
};

}  // namespace tetwarp
