/// @file elastic_space.hpp
/// How elastic bodies give way to contacts, by the factors of their systems at rest.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "host/simulate/solve/problem/contact_islands.hpp"
#include "host/simulate/solve/problem/contact_rows.hpp"
#include "host/simulate/step/cpu/rest_factors.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

/// A body whose coupling island is taken, with the nodes that contacts touch.
struct ElasticBody {
  std::int32_t body = -1, row_begin = 0, row_end = 0;
  RestFactor* factor = nullptr;
  std::array<double, 9> rotation{};   ///< R, of the mean of the body; rows first
  std::vector<std::int32_t> touched;  ///< nodes, from row_begin, ascending; of the last steps
  std::int64_t first = 0, size = 0;   ///< its numbers of y: three of each touched node, padded to
                                      ///< a multiple of 8
  std::vector<float> compliance;      ///< [3 touched][size] of M^-1, a column at a time

  /// What the compliance was computed for. It is kept as long as contacts touch no other nodes.
  struct Source {
    std::int32_t body = -1;
    double time_step = 0, damping = 0;
    std::vector<std::int32_t> touched;
  };
  Source source;
};

/// Which bodies are solved by their factors at rest, M^-1 = R A_0^-1 R^T, and their compliance at
/// the nodes that contacts touch. Bodies coupled to others, cloth, those with very many nodes and
/// those with very many touched nodes are not.
class ElasticSpace {
 public:
  explicit ElasticSpace(std::shared_ptr<RestFactors> factors);

  /// Chooses among the coupling islands that are taken.
  void choose(const SystemRows& rows,
              const ContactIslands& islands,
              const std::vector<std::uint8_t>& takes,
              const ContactRows& contact_rows,
              const std::vector<std::int32_t>& contacts);
  /// @param first    place of the first number of touched nodes in y
  /// @param damping  a power of two: M^-1 becomes damping R A_0^-1 R^T
  void set(
      const ModelState& state, double time_step, std::int64_t first, double damping, int threads);

  const std::vector<ElasticBody>& bodies() const { return bodies_; }
  /// Place in bodies() of the body of a row, or -1.
  std::int32_t body_of_row(std::int64_t row) const {
    return body_of_row_[static_cast<std::size_t>(row)];
  }
  /// Place of a row in ElasticBody::touched, or -1.
  std::int32_t slot_of_row(std::int64_t row) const {
    return slot_of_row_[static_cast<std::size_t>(row)];
  }
  std::int64_t size() const { return size_; }

  /// out = M^-1 push of a body, [rows][3] from its first row.
  void solve(std::size_t body, const double* push, double* out);
  /// Copies the velocities of its touched nodes, in the frame of the body at rest, to y.
  void gather(std::size_t body, const double* rows, double* y) const;

 private:
  void set_touched(ElasticBody& own) const;
  void set_compliance(ElasticBody& own, double time_step) const;

  std::shared_ptr<RestFactors> factors_;
  std::vector<ElasticBody> bodies_;
  std::vector<std::int32_t> body_of_row_, slot_of_row_, row_of_block_;
  std::vector<std::int32_t> needed_;  ///< nodes of a body that contacts touch
  std::int64_t size_ = 0;
  double damping_ = 1;
};

}  // namespace tetwarp
