/// @file random_step.hpp
/// A random system of a step with contacts on its rows, as the stages of kernels/contact have it
/// and as sparse matrices of Eigen.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <Eigen/SparseCore>

#include "host/base/index_of.hpp"
#include "kernels/contact/row_start.hpp"
#include "tests/simulate/random_contacts.hpp"

namespace tetwarp::test {

/// As many contacts as rows. Elastic bodies, islands of a rigid body and two nodes, and single
/// rigid bodies take turns. Before each island there is a row of the system that is not taken; all
/// rows have a column of a prescribed one, the last.
class RandomStep {
 public:
  using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  static constexpr double damping = 0.5, relaxation = 1.3;

  explicit RandomStep(std::int32_t size) : random_(static_cast<unsigned>(size)) {
    for (int n = 0; row_count() < size; ++n) add_island(n % 3, size - row_count());
    for (std::int32_t& column : column_) column = column < 0 ? system_count() : column;
    number_blocks();
    for (std::int32_t c = 0; c < size; ++c) add_contact();
    part_block_.push_back(static_cast<std::int32_t>(row_.size()));
    list_nodes();
    list_touching();
    set_matrices();
  }

  std::int32_t row_count() const { return static_cast<std::int32_t>(body_of_row_.size()); }
  std::int32_t system_count() const { return static_cast<std::int32_t>(pair_.size()); }
  std::int64_t block_count() const { return static_cast<std::int64_t>(row_.size()); }
  std::int64_t part_count() const { return static_cast<std::int64_t>(part_body_.size()); }
  Eigen::VectorXd vector(std::int64_t size) {
    return Eigen::VectorXd::NullaryExpr(size, [this] { return number(); });
  }
  SystemRows system() const {
    SystemRows rows;
    rows.count = system_count() + 1;
    rows.unknown_count = system_count();
    rows.block_of = view(block_of_);
    rows.start = view(start_);
    rows.free_end = view(free_end_);
    rows.column = view(column_);
    rows.diagonal = view(diagonal_);
    rows.pair = view(pair_);
    return rows;
  }
  View<const double> values() const { return view(values_); }
  View<const std::int32_t> system_row() const { return view(system_row_); }
  View<const std::int32_t> diagonal_rows() const { return view(diagonal_rows_); }
  /// @param compliance, inverse  not yet set
  CompliantBodies compliant(std::vector<float>& compliance, std::vector<double>& inverse) const {
    const SystemRows rows = system();
    compliance.assign(index_of(compliance_size_), 0);
    inverse.assign(index_of(9 * std::int64_t{system_count()} + 18 * std::int64_t{pair_rows_}), 0.0);
    return {view(bodies_),
            view(body_of_row_),
            view(row_of_node_),
            view(rotation_),
            view(std::as_const(compliance)),
            {rows.pair, rows.block_of, system_count(), system_count() - pair_rows_, view(inverse)},
            damping};
  }
  TouchingRows touching(const Eigen::VectorXd& offset) const {
    return {view(block_start_), view(row_),   view(node_),
            view(contact_),     view(part_),  view(jacobian_),
            view(touch_start_), view(touch_), {offset.data(), offset.size()}};
  }
  TouchingNodes touching_nodes(const CompliantBodies& of, const TouchingRows& rows) const {
    return {of, rows, view(turned_), view(part_start_), view(part_block_), view(part_body_)};
  }
  const std::vector<double>& turned() const { return turned_; }

  Sparse a;          ///< A of the rows
  Sparse inverses;   ///< M^-1 in frames
  Sparse rotations;  ///< R
  Sparse jacobian;   ///< J
  Sparse parts;      ///< of each part J R, [3 parts][3 rows]
  Sparse sum_parts;  ///< [3 contacts][3 parts]
  Sparse picks;      ///< the rows of nodes, [3 nodes][3 rows]

 private:
  using Block = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  using Triplets = std::vector<Eigen::Triplet<double>>;

  double number() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  std::int32_t below(std::int32_t count) {
    return std::uniform_int_distribution<std::int32_t>(0, count - 1)(random_);
  }
  /// 1 + u u^T; its inverse is 1 - u u^T / (1 + u . u).
  static Eigen::MatrixXd positive(const Eigen::VectorXd& u) {
    return Eigen::MatrixXd::Identity(u.size(), u.size()) + u * u.transpose();
  }
  static void add(Triplets& to, Eigen::Index row, Eigen::Index column, const Eigen::MatrixXd& of) {
    for (Eigen::Index i = 0; i < of.rows(); ++i) {
      for (Eigen::Index j = 0; j < of.cols(); ++j) to.emplace_back(row + i, column + j, of(i, j));
    }
  }
  static Sparse matrix(std::int64_t rows, std::int64_t columns, const Triplets& of) {
    Sparse result(3 * rows, 3 * columns);
    result.setFromTriplets(of.begin(), of.end());
    return result;
  }

  void add_island(int kind, std::int32_t most) {
    const auto largest = std::min(6 + static_cast<std::int32_t>(bodies_.size()), 20);
    const std::vector<std::int32_t> wanted[] = {{largest}, {2, 1, 1}, {2}};
    std::vector<std::int32_t> counts;
    std::int32_t sum = 0;
    for (const std::int32_t count : wanted[kind]) {
      counts.push_back(std::min(count, most - sum));
      sum += counts.back();
    }
    add_system_rows(positive(vector(3)));
    const std::int32_t first = system_count(), first_row = row_count();
    const Eigen::VectorXd of_island = vector(3 * sum);
    add_system_rows(positive(of_island));
    add(of_a_, 3 * first_row, 3 * first_row, positive(of_island));
    for (const std::int32_t count : counts) {
      const Eigen::Index place = 3 * (row_count() - first_row);
      if (count > 0) add_body(kind, first, of_island.segment(place, 3 * count));
    }
  }
  void add_system_rows(const Eigen::MatrixXd& own) {
    const std::int32_t first = system_count();
    for (Eigen::Index i = 0; i < own.rows(); i += 3) {
      start_.push_back(static_cast<std::int32_t>(column_.size()));
      diagonal_.push_back(start_.back() + static_cast<std::int32_t>(i / 3));
      for (Eigen::Index j = 0; j < own.cols(); j += 3) {
        column_.push_back(first + static_cast<std::int32_t>(j / 3));
        const Eigen::Matrix3d block = own.block<3, 3>(i, j);
        values_.insert(values_.end(), block.data(), block.data() + 9);
      }
      free_end_.push_back(static_cast<std::int32_t>(column_.size()));
      column_.push_back(-1);  // prescribed
      for (int e = 0; e < 9; ++e) values_.push_back(number());
      pair_.push_back(0);
    }
  }
  /// @param first  system row of the island
  /// @param u      its block of A is positive(u)
  void add_body(int kind, std::int32_t first, const Eigen::VectorXd& u) {
    CompliantBody own;
    own.first = row_count();
    own.count = static_cast<std::int32_t>(u.size() / 3);
    own.system_row = bodies_.empty() || bodies_.back().system_row < first
                         ? first
                         : bodies_.back().system_row + bodies_.back().count;
    Block turn = Block::Identity();
    if (kind == 0) {
      const Eigen::MatrixXf inverse = positive(vector(u.size())).cast<float>();
      inverses_.emplace_back(inverse.data(), inverse.data() + inverse.size());
      own.inverse = inverses_.back().data();
      own.frame = static_cast<std::int32_t>(rotation_.size() / 9);
      turn = Eigen::Quaterniond(number(), number(), number(), number()).normalized().matrix();
      rotation_.insert(rotation_.end(), turn.data(), turn.data() + 9);
      add(of_inverses_, 3 * own.first, 3 * own.first, damping * inverse.cast<double>());
    } else {
      own.relaxation = kind == 1 ? relaxation : 1;
      diagonal_rows_.push_back(own.system_row);
      add(of_inverses_, 3 * own.first, 3 * own.first,
          own.relaxation * (Eigen::MatrixXd::Identity(u.size(), u.size()) -
                            u * u.transpose() / (1 + u.squaredNorm())));
      if (own.count == 2) {
        pair_[index_of(own.system_row)] = 1;
        pair_[index_of(own.system_row) + 1] = 2;
        pair_rows_ += 2;
      }
    }
    for (std::int32_t r = 0; r < own.count; ++r) {
      add(of_rotations_, 3 * row_count(), 3 * row_count(), turn);
      system_row_.push_back(own.system_row + r);
      body_of_row_.push_back(static_cast<std::int32_t>(bodies_.size()));
    }
    bodies_.push_back(own);
  }
  /// Nodes are numbered against the order of their rows, then rigid bodies along it.
  void number_blocks() {
    std::int32_t node = system_count() - pair_rows_, rigid = node;
    for (const std::uint8_t pair : pair_) block_of_.push_back(pair == 0 ? --node : rigid++);
  }

  /// On one body or two.
  void add_contact() {
    const auto count = static_cast<std::int32_t>(bodies_.size());
    const std::int32_t first = below(count), second = below(count);
    add_part(std::min(first, second));
    if (first != second) add_part(std::max(first, second));
    block_start_.push_back(static_cast<std::int32_t>(row_.size()));
    part_start_.push_back(static_cast<std::int32_t>(part_body_.size()));
  }
  void add_part(std::int32_t number_of_body) {
    CompliantBody& own = bodies_[index_of(number_of_body)];
    const std::int32_t count = own.frame < 0 ? own.count : 1 + below(std::min(3, own.count));
    const std::int32_t first = own.first + below(own.count - count + 1);
    const auto part = static_cast<std::int32_t>(part_body_.size());
    part_block_.push_back(static_cast<std::int32_t>(row_.size()));
    for (std::int32_t row = first; row < first + count; ++row) {
      Block block = Block::NullaryExpr([this] { return number(); });
      const auto contact = static_cast<std::int32_t>(block_start_.size()) - 1;
      if (contact == 0) block.row(2).setZero();  // it does not move along its second tangent
      jacobian_.insert(jacobian_.end(), block.data(), block.data() + 9);
      add(of_jacobian_, 3 * contact, 3 * row, block);
      if (own.frame >= 0) block = block * Block(rotation_.data() + 9 * own.frame);
      turned_.insert(turned_.end(), block.data(), block.data() + 9);
      add(of_parts_, 3 * part, 3 * row, block);
      row_.push_back(row);
      contact_.push_back(contact);
      part_.push_back(part);
    }
    add(of_sums_, 3 * contact_.back(), 3 * part, Block::Identity());
    part_body_.push_back(number_of_body);
    ++own.contact_count;
  }
  void list_nodes() {
    std::vector<std::int32_t> node_of(body_of_row_.size(), -1);
    for (const std::int32_t row : row_) node_of[index_of(row)] = 0;
    for (CompliantBody& own : bodies_) {
      own.first_node = static_cast<std::int32_t>(row_of_node_.size());
      own.compliance = compliance_size_;
      for (std::int32_t row = own.first; row < own.first + own.count; ++row) {
        if (node_of[index_of(row)] < 0) continue;
        node_of[index_of(row)] = static_cast<std::int32_t>(row_of_node_.size());
        add(of_picks_, 3 * node_of[index_of(row)], 3 * row, Block::Identity());
        row_of_node_.push_back(row);
        ++own.node_count;
      }
      compliance_size_ += 9 * std::int64_t{own.node_count} * own.node_count;
    }
    for (const std::int32_t row : row_) node_.push_back(node_of[index_of(row)]);
  }
  void list_touching() {
    std::vector<std::vector<std::int32_t>> of_row(body_of_row_.size());
    for (std::size_t b = 0; b < row_.size(); ++b) {
      of_row[index_of(row_[b])].push_back(static_cast<std::int32_t>(b));
    }
    for (const auto& own : of_row) {
      touch_.insert(touch_.end(), own.begin(), own.end());
      touch_start_.push_back(static_cast<std::int32_t>(touch_.size()));
    }
  }
  void set_matrices() {
    const std::int64_t rows = row_count(), contacts = rows;
    a = matrix(rows, rows, of_a_);
    inverses = matrix(rows, rows, of_inverses_);
    rotations = matrix(rows, rows, of_rotations_);
    jacobian = matrix(contacts, rows, of_jacobian_);
    parts = matrix(part_count(), rows, of_parts_);
    sum_parts = matrix(contacts, part_count(), of_sums_);
    picks = matrix(static_cast<std::int64_t>(row_of_node_.size()), rows, of_picks_);
  }

  std::mt19937 random_;
  Triplets of_a_, of_inverses_, of_rotations_, of_jacobian_, of_parts_, of_sums_, of_picks_;
  std::vector<CompliantBody> bodies_;
  std::vector<std::vector<float>> inverses_;
  std::int64_t compliance_size_ = 0;
  std::int32_t pair_rows_ = 0;  ///< rows of rigid bodies
  std::vector<std::int32_t> start_, free_end_, column_, diagonal_, block_of_;
  std::vector<std::uint8_t> pair_;
  std::vector<std::int32_t> body_of_row_, system_row_, diagonal_rows_, row_of_node_;
  std::vector<std::int32_t> row_, node_, contact_, part_, part_body_, part_block_, touch_;
  std::vector<std::int32_t> block_start_{0}, part_start_{0}, touch_start_{0};
  std::vector<double> values_, rotation_, jacobian_, turned_;
};

}  // namespace tetwarp::test
