/// Rows and lists of contacts on compliant bodies, made by stages, against a dense matrix and lists
/// made in their order.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "host/base/index_of.hpp"
#include "kernels/contact/touch_lists.hpp"
#include "tests/simulate/random_contacts.hpp"

namespace tetwarp::test {
namespace {

using Eigen::Map;
using Eigen::Vector3d;
constexpr std::int32_t body_nodes = 5, bodies_of_nodes = 6, frames = 4;
constexpr std::int32_t node_count = body_nodes * bodies_of_nodes;

/// Contacts on the surfaces of bodies of five nodes and of frames, some of which are not solved.
class RandomTouches {
 public:
  explicit RandomTouches(std::int32_t contact_count) {
    list_rows();
    for (double& x : center_) x = number();
    for (std::int32_t body = 0; body < bodies_of_nodes + frames; ++body) {
      for (int v = 0; v < 4; ++v) add_point(body);
    }
    for (std::int32_t c = 0; c < contact_count; ++c) {
      ContactSides& contact = contacts.emplace_back();
      for (double& x : contact.axes) x = number();
      set_side(contact.a);
      set_side(contact.b);
    }
  }

  TouchListInput input() const {
    return {view(contacts),
            {view(points_), view(center_), node_count},
            view(row_of_block_),
            view(body_of_row)};
  }
  /// Velocity of a contact for unit velocities of the rows, and the rows that move it.
  Eigen::MatrixXd jacobian(std::int64_t contact, std::set<std::int32_t>& rows) const {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(3, 3 * std::ssize(body_of_row));
    const ContactSides& of = contacts[index_of(contact)];
    add_side(of.a, 1, sum, rows);
    add_side(of.b, -1, sum, rows);
    const Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> axes(of.axes);
    return axes * sum;
  }

  std::vector<ContactSides> contacts;
  std::vector<CompliantBody> bodies;
  std::vector<std::int32_t> body_of_row;

 private:
  double number() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  std::int32_t below(std::int32_t count) {
    return std::uniform_int_distribution<std::int32_t>(0, count - 1)(random_);
  }
  /// Bodies are solved in another order than that of their blocks; the first and the last are not.
  void list_rows() {
    row_of_block_.assign(index_of(node_count + 2 * frames), -1);
    for (std::int32_t body = bodies_of_nodes + frames - 2; body > 0; --body) {
      const bool has_nodes = body < bodies_of_nodes;
      CompliantBody& own = bodies.emplace_back();
      own.first = static_cast<std::int32_t>(body_of_row.size());
      own.count = has_nodes ? body_nodes : 2;
      const std::int32_t block =
          has_nodes ? body_nodes * body : node_count + 2 * (body - bodies_of_nodes);
      for (std::int32_t k = 0; k < own.count; ++k) {
        row_of_block_[index_of(block + k)] = own.first + k;
        body_of_row.push_back(static_cast<std::int32_t>(bodies.size()) - 1);
      }
    }
  }
  void add_point(std::int32_t body) {
    SurfacePoint point{{-1, -1, -1, -1}, -1, body, {0, 0, 0, 0}, {0, 0, 0}};
    if (body >= bodies_of_nodes) {
      point.rigid = body - bodies_of_nodes;
    } else {
      const int nodes = 1 + below(4), first = below(body_nodes);
      for (int n = 0; n < nodes; ++n) {
        point.node[n] = body_nodes * body + (first + n) % body_nodes;
        point.weight[n] = n == 1 ? 0 : number();
      }
    }
    points_.push_back(point);
  }
  void set_side(ContactSide& side) {
    for (double& x : side.point) x = number();
    const std::int32_t body = below(bodies_of_nodes + frames + 1);
    if (body == bodies_of_nodes + frames) return;  // does not move
    if (body >= bodies_of_nodes && below(2) == 0) {
      side.frame = body - bodies_of_nodes;
      return;
    }
    const int vertices = 1 + below(3);
    for (int k = 0; k < vertices; ++k) {
      side.vertex[k] = 4 * body + k;
      side.weight[k] = number();
    }
  }

  void add_side(const ContactSide& side,
                double sign,
                Eigen::MatrixXd& sum,
                std::set<std::int32_t>& rows) const {
    if (side.frame >= 0) return add_frame(side, side.frame, sign, sum, rows);
    for (int k = 0; k < 3 && side.vertex[k] >= 0; ++k) {
      const SurfacePoint& point = points_[index_of(side.vertex[k])];
      const double weight = sign * side.weight[k];
      if (point.rigid >= 0) add_frame(side, point.rigid, weight, sum, rows);
      for (int n = 0; n < 4 && point.node[n] >= 0; ++n) {
        add_block(point.node[n], weight * point.weight[n] * Eigen::Matrix3d::Identity(), sum, rows);
      }
    }
  }
  void add_frame(const ContactSide& side,
                 std::int32_t frame,
                 double weight,
                 Eigen::MatrixXd& sum,
                 std::set<std::int32_t>& rows) const {
    const Vector3d center(&center_[index_of(3 * frame)]), arm = Vector3d(side.point) - center;
    Eigen::Matrix3d turning;  // omega x arm
    turning << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
    const std::int32_t block = node_count + 2 * frame;
    add_block(block, weight * Eigen::Matrix3d::Identity(), sum, rows);
    add_block(block + 1, weight * turning, sum, rows);
  }
  void add_block(std::int32_t block,
                 const Eigen::Matrix3d& value,
                 Eigen::MatrixXd& sum,
                 std::set<std::int32_t>& rows) const {
    const std::int32_t row = row_of_block_[index_of(block)];
    if (row < 0) return;
    sum.middleCols<3>(3 * row) += value;
    rows.insert(row);
  }

  std::mt19937 random_{11};
  std::vector<SurfacePoint> points_;
  std::vector<double> center_ = std::vector<double>(3 * frames);
  std::vector<std::int32_t> row_of_block_;
};

/// What the stages make.
struct TouchLists {
  explicit TouchLists(const RandomTouches& of) : bodies(of.bodies) {
    const TouchListInput in = of.input();
    const std::int64_t contacts = std::ssize(of.contacts), rows = std::ssize(of.body_of_row);
    std::vector<std::int64_t> sums(index_of(TouchSums::size(contacts, rows)), 0);
    const TouchSums counted = {view(sums), contacts};
    each(contacts, TouchCountOp{in, counted});
    std::exclusive_scan(sums.begin(), sums.end(), sums.begin(), std::int64_t{0});
    std::vector<std::int64_t> squares(bodies.size() + 1);
    each(std::ssize(squares), BodyNodesOp{counted, view(bodies), view(squares)});
    std::exclusive_scan(squares.begin(), squares.end(), squares.begin(), std::int64_t{0});
    const View<const std::int64_t> squares_before = view(std::as_const(squares));
    TouchTotalsOp{counted, rows, squares_before, &totals}(0);
    for (auto* const list : {&row, &node, &contact, &part, &touch}) {
      list->resize(index_of(totals.blocks));
    }
    for (auto* const list : {&block_start, &part_start}) list->resize(index_of(contacts + 1));
    part_block.resize(index_of(totals.parts + 1));
    part_body.resize(index_of(totals.parts));
    jacobian.resize(index_of(9 * totals.blocks));
    row_of_node.resize(index_of(totals.nodes));
    pair_start.resize(index_of(totals.nodes + 1));
    touch_start.resize(index_of(rows + 1));
    each(rows + 1, NodeListOp{counted, in.body_of_row, squares_before, view(bodies),
                              view(row_of_node), view(pair_start)});
    std::vector<KeyValue> touches(row.size());
    each(contacts + 1,
         TouchListOp{in, counted, view(bodies), view(block_start), view(part_start), view(row),
                     view(node), view(contact), view(part), view(part_block), view(part_body),
                     view(jacobian), view(touches)});
    std::sort(touches.begin(), touches.end());
    each(std::max(rows + 1, totals.blocks),
         RowTouchesOp{view(std::as_const(touches)), view(touch_start), view(touch)});
  }

  TouchTotals totals{};
  std::vector<CompliantBody> bodies;
  std::vector<std::int32_t> block_start, part_start, row, node, contact, part, part_block,
      part_body, touch_start, touch, row_of_node;
  std::vector<std::int64_t> pair_start;
  std::vector<double> jacobian;

 private:
  /// In reverse: stages have no order.
  template <class Op>
  static void each(std::int64_t count, const Op& op) {
    for (std::int64_t i = count - 1; i >= 0; --i) op(i);
  }
};

template <class Check>
void at_all_sizes(const Check& check) {
  for (const std::int32_t size : {0, 1, 31, 32, 33, 1025}) {
    SCOPED_TRACE(size);
    const RandomTouches touches(size);
    check(touches, TouchLists(touches));
  }
}

TEST(TouchListStages, BlocksAreThoseOfTheDenseMatrix) {
  at_all_sizes([](const RandomTouches& of, const TouchLists& lists) {
    ASSERT_EQ(lists.block_start.back(), std::ssize(lists.row));
    for (std::int64_t c = 0; c < std::ssize(of.contacts); ++c) {
      std::set<std::int32_t> rows;
      Eigen::MatrixXd left = of.jacobian(c, rows);
      for (auto b = index_of(lists.block_start[index_of(c)]);
           b < index_of(lists.block_start[index_of(c) + 1]); ++b) {
        const Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> block(&lists.jacobian[9 * b]);
        left.middleCols<3>(3 * lists.row[b]) -= block;
        EXPECT_EQ(rows.erase(lists.row[b]), 1u);
        EXPECT_EQ(lists.contact[b], c);
      }
      EXPECT_TRUE(rows.empty());
      EXPECT_LE(left.cwiseAbs().maxCoeff(), 1e-14);
    }
  });
}

TEST(TouchListStages, PartsAreTheBlocksOfOneBody) {
  at_all_sizes([](const RandomTouches& of, const TouchLists& lists) {
    std::vector<std::int32_t> part_start{0}, part_block, part_body, count(of.bodies.size());
    for (std::size_t c = 0; c < of.contacts.size(); ++c) {
      for (auto b = index_of(lists.block_start[c]); b < index_of(lists.block_start[c + 1]); ++b) {
        const std::int32_t body = of.body_of_row[index_of(lists.row[b])];
        const bool is_first = std::ssize(part_body) == part_start.back();
        if (is_first || part_body.back() != body) {
          part_block.push_back(static_cast<std::int32_t>(b));
          part_body.push_back(body);
          ++count[index_of(body)];
        }
        EXPECT_EQ(lists.part[b], std::ssize(part_body) - 1);
      }
      part_start.push_back(static_cast<std::int32_t>(part_body.size()));
    }
    part_block.push_back(static_cast<std::int32_t>(lists.row.size()));
    EXPECT_EQ(lists.part_start, part_start);
    EXPECT_EQ(lists.part_block, part_block);
    EXPECT_EQ(lists.part_body, part_body);
    for (std::size_t b = 0; b < count.size(); ++b) {
      EXPECT_EQ(lists.bodies[b].contact_count, count[b]);
    }
  });
}

TEST(TouchListStages, NodesAreTheRowsThatContactsTouch) {
  at_all_sizes([](const RandomTouches& of, const TouchLists& lists) {
    const std::set<std::int32_t> touched(lists.row.begin(), lists.row.end());
    const std::vector<std::int32_t> nodes(touched.begin(), touched.end());
    EXPECT_EQ(lists.row_of_node, nodes);
    for (std::size_t b = 0; b < lists.row.size(); ++b) {
      EXPECT_EQ(lists.row_of_node[index_of(lists.node[b])], lists.row[b]);
    }
    std::vector<std::int64_t> pair_start{0};
    std::int32_t next = 0;
    for (std::size_t b = 0; b < of.bodies.size(); ++b) {
      const CompliantBody& own = lists.bodies[b];
      EXPECT_EQ(own.first_node, next);
      EXPECT_EQ(own.compliance, 9 * pair_start.back());
      const auto count = std::ranges::count_if(
          nodes, [&](std::int32_t row) { return row >= own.first && row < own.first + own.count; });
      EXPECT_EQ(own.node_count, count);
      for (std::int32_t n = 0; n < own.node_count; ++n) {
        pair_start.push_back(pair_start.back() + own.node_count);
      }
      next += own.node_count;
    }
    EXPECT_EQ(lists.pair_start, pair_start);
    EXPECT_EQ(lists.totals.node_pairs, pair_start.back());
  });
}

TEST(TouchListStages, RowsListTheirBlocksInOrder) {
  at_all_sizes([](const RandomTouches& of, const TouchLists& lists) {
    std::vector<std::int32_t> touch_start{0}, touch;
    for (std::int32_t row = 0; row < std::ssize(of.body_of_row); ++row) {
      for (std::size_t b = 0; b < lists.row.size(); ++b) {
        if (lists.row[b] == row) touch.push_back(static_cast<std::int32_t>(b));
      }
      touch_start.push_back(static_cast<std::int32_t>(touch.size()));
    }
    EXPECT_EQ(lists.touch_start, touch_start);
    EXPECT_EQ(lists.touch, touch);
  });
}

}  // namespace
}  // namespace tetwarp::test
