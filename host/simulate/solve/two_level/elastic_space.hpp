/// @file elastic_space.hpp
/// How elastic bodies give way to contacts, by the factors of their systems at rest.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "host/simulate/solve/two_level/two_level_start.hpp"
#include "host/simulate/step/cpu/rest_factors.hpp"

namespace tetwarp {

/// A body that is solved by its factor at rest, with the nodes that contacts touch.
struct ElasticBody {
  std::int32_t body = -1, row_begin = 0, row_end = 0;  ///< of the model; rows of the lists
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

/// Bodies that are solved by their factors at rest, M^-1 = R A_0^-1 R^T, and their compliance at
/// the nodes that contacts touch.
class ElasticSpace {
 public:
  explicit ElasticSpace(std::shared_ptr<RestFactors> factors);

  /// Finds bodies with so many touched nodes that they give way by their diagonal blocks instead.
  /// @param body_of  [blocks] elastic bodies, or -1
  /// @param bare     in and out, [bodies of the model]; 1: such a body
  static void find_bare(const SoftProblem& problem,
                        const std::vector<std::int32_t>& body_of,
                        std::vector<std::uint8_t>& bare);

  /// Sets the bodies that have a frame, and which of their nodes contacts touch.
  /// @param lists  kept by the caller
  void set_bodies(const CompliantLists& lists,
                  const ContactRows& contact_rows,
                  const std::vector<std::int32_t>& contacts);
  /// @param damping  a power of two: M^-1 becomes damping R A_0^-1 R^T
  void set(const TwoLevelStart& start, double damping, int threads);

  const std::vector<ElasticBody>& bodies() const { return bodies_; }
  /// Place in bodies() of the body of a row, or -1.
  std::int32_t body_of_row(std::int64_t row) const { return lists_->body_at(row).frame; }
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
  const CompliantLists* lists_ = nullptr;
  std::vector<ElasticBody> bodies_;  ///< [frames]
  std::vector<std::int32_t> slot_of_row_;
  std::vector<std::int32_t> needed_;  ///< nodes of a body that contacts touch
  std::int64_t size_ = 0;
  double damping_ = 1;
};

}  // namespace tetwarp
