/// @file random_contacts.hpp
/// Random contacts on compliant bodies, those of two rods, and their dense matrix.
#pragma once
#include <algorithm>
#include <cstdint>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "kernels/contact/majorant.hpp"

namespace tetwarp::test {

template <class T>
View<const T> view(const std::vector<T>& values) {
  return {values.data(), static_cast<std::int64_t>(values.size())};
}
template <class T>
View<T> view(std::vector<T>& values) {
  return {values.data(), static_cast<std::int64_t>(values.size())};
}

/// Contacts of two rods along x, held at both ends along x, '1' those of the first rod. Of such a
/// rod only the motion along x has the largest eigenvalue of D^-1 J M^-1 J^T, 12 for its 12
/// contacts, if its moments of inertia are m L^2 with ends at -L and L; the others have 6. The sum
/// of scattered() over the contacts of the first rod is nearly 0 along x, so that the power
/// iteration starts without the largest eigenvalue and ends near 6.
constexpr std::string_view missed_contacts = "000010110001111011100110";

/// Elastic bodies of several nodes, each turned, with random inverses and contacts.
class RandomContacts {
 public:
  RandomContacts(unsigned seed, std::int32_t body_count, std::int32_t contact_count)
      : random_(seed) {
    for (std::int32_t b = 0; b < body_count; ++b) add_body(2 + b);
    set_views();
    for (std::int32_t c = 0; c < contact_count; ++c) add_contact();
    finish();
  }

  /// `missed_contacts` on rods of mass and moments 1: rows of velocity and of angular velocity.
  static RandomContacts of_rods() {
    RandomContacts rods;
    const Eigen::MatrixXd unit = Eigen::MatrixXd::Identity(6, 6);
    for (int rod = 0; rod < 2; ++rod) rods.add_body(unit);
    rods.set_views();
    const double moving[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (const char c : missed_contacts) {
      const std::int32_t body = c == '1' ? 0 : 1;
      CompliantBody& own = rods.bodies_[static_cast<std::size_t>(body)];
      const double end = own.contact_count % 2 == 0 ? 1 : -1;
      const double turning[9] = {0, 0, 0, 0, 0, end, 0, -end, 0};  // lever x axis
      rods.add_block(own.first, moving);
      rods.add_block(own.first + 1, turning);
      rods.end_part(body);
      rods.end_contact();
    }
    rods.finish();
    return rods;
  }

  TouchingNodes touching() const {
    TouchingNodes all;
    all.bodies = bodies_of_;
    all.rows.block_start = view(block_start_);
    all.rows.row = all.rows.node = view(row_);
    all.rows.contact = view(contact_);
    all.rows.part = view(part_);
    all.rows.touch_start = view(touch_start_);
    all.rows.touch = view(touch_);
    all.turned = view(turned_);
    all.part_start = view(part_start_);
    all.part_block = view(part_block_);
    all.part_body = view(part_body_);
    return all;
  }
  std::int64_t contact_count() const { return static_cast<std::int64_t>(block_start_.size()) - 1; }
  std::int64_t part_count() const { return static_cast<std::int64_t>(part_body_.size()); }

  /// J M^-1 J^T from the inverses.
  Eigen::MatrixXd dense() const {
    const auto nodes = static_cast<Eigen::Index>(3 * body_of_row_.size());
    Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(nodes, nodes);
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const Eigen::Index first = 3 * bodies_[b].first, size = 3 * bodies_[b].count;
      inverse.block(first, first, size, size) =
          Eigen::Map<const Eigen::MatrixXf>(inverses_[b].data(), size, size).cast<double>();
    }
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(3 * contact_count(), nodes);
    for (std::size_t b = 0; b < row_.size(); ++b) {
      jacobian.block<3, 3>(3 * contact_[b], 3 * row_[b]) +=
          Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(turned_.data() + 9 * b);
    }
    return jacobian * inverse * jacobian.transpose();
  }

 private:
  RandomContacts() = default;

  double number() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  std::int32_t below(std::int32_t count) {
    return std::uniform_int_distribution<std::int32_t>(0, count - 1)(random_);
  }

  void add_body(std::int32_t rows) {
    Eigen::MatrixXd factor(3 * rows, 3 * rows);
    for (Eigen::Index i = 0; i < factor.size(); ++i) factor.data()[i] = number();
    // Nodes mostly move together, as those of a body that contacts push.
    add_body(factor * factor.transpose() +
             Eigen::MatrixXd::Constant(3 * rows, 3 * rows, 5.0 * rows));
  }
  void add_body(const Eigen::MatrixXd& inverse) {
    CompliantBody own;
    own.first = own.first_node = static_cast<std::int32_t>(body_of_row_.size());
    own.count = own.node_count = static_cast<std::int32_t>(inverse.rows() / 3);
    const Eigen::MatrixXf rounded = inverse.cast<float>();
    inverses_.emplace_back(rounded.data(), rounded.data() + rounded.size());
    for (std::int32_t r = 0; r < own.count; ++r) {
      row_of_node_.push_back(static_cast<std::int32_t>(body_of_row_.size()));
      body_of_row_.push_back(static_cast<std::int32_t>(bodies_.size()));
    }
    bodies_.push_back(own);
  }

  /// Between two bodies, or one and what does not move.
  void add_contact() {
    std::int32_t a = below(static_cast<std::int32_t>(bodies_.size()));
    std::int32_t b = below(static_cast<std::int32_t>(bodies_.size()) + 1) - 1;
    if (b >= 0 && b < a) std::swap(a, b);
    add_part(a);
    if (b > a) add_part(b);
    end_contact();
  }
  void end_contact() {
    block_start_.push_back(static_cast<std::int32_t>(row_.size()));
    part_start_.push_back(static_cast<std::int32_t>(part_body_.size()));
  }

  void add_part(std::int32_t body) {
    const CompliantBody& own = bodies_[static_cast<std::size_t>(body)];
    const std::int32_t count = 1 + below(std::min(3, own.count));
    for (std::int32_t k = 0; k < count; ++k) {
      double jacobian[9];
      for (double& value : jacobian) value = number();
      add_block(own.first + k, jacobian);
    }
    end_part(body);
  }
  void add_block(std::int32_t row, const double* jacobian) {
    row_.push_back(row);
    contact_.push_back(static_cast<std::int32_t>(block_start_.size()) - 1);
    part_.push_back(static_cast<std::int32_t>(part_body_.size()));
    turned_.insert(turned_.end(), jacobian, jacobian + 9);
  }
  void end_part(std::int32_t body) {
    part_body_.push_back(body);
    part_block_.push_back(static_cast<std::int32_t>(row_.size()));
    ++bodies_[static_cast<std::size_t>(body)].contact_count;
  }

  void set_views() {
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      bodies_[b].inverse = inverses_[b].data();
      bodies_[b].compliance = static_cast<std::int64_t>(compliance_.size());
      compliance_.resize(compliance_.size() + inverses_[b].size());
    }
  }

  void finish() {
    for (std::int32_t row = 0; row < static_cast<std::int32_t>(body_of_row_.size()); ++row) {
      touch_start_.push_back(static_cast<std::int32_t>(touch_.size()));
      for (std::size_t b = 0; b < row_.size(); ++b) {
        if (row_[b] == row) touch_.push_back(static_cast<std::int32_t>(b));
      }
    }
    touch_start_.push_back(static_cast<std::int32_t>(touch_.size()));
    bodies_of_.bodies = view(bodies_);
    bodies_of_.body_of_row = view(body_of_row_);
    bodies_of_.row_of_node = view(row_of_node_);
    const ComplianceBlockOp fill{bodies_of_, view(compliance_)};
    for (std::size_t node = 0; node < row_of_node_.size(); ++node) {
      const CompliantBody& own = bodies_[static_cast<std::size_t>(body_of_row_[node])];
      for (std::int32_t k = 0; k < own.node_count; ++k) fill(static_cast<std::int64_t>(node), k, 0);
    }
    bodies_of_.compliance = view(std::as_const(compliance_));
  }

  std::mt19937 random_;
  std::vector<CompliantBody> bodies_;
  std::vector<std::vector<float>> inverses_;
  std::vector<float> compliance_;
  std::vector<std::int32_t> body_of_row_, row_of_node_, row_, contact_, part_, part_body_;
  std::vector<std::int32_t> block_start_{0}, part_start_{0}, part_block_{0}, touch_start_, touch_;
  std::vector<double> turned_;
  CompliantBodies bodies_of_;
};

}  // namespace tetwarp::test
