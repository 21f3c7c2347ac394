/// @file coarse_space.hpp
/// Affine motions of whole bodies. The block-Jacobi iteration of A v = b changes them least,
/// because the stiffness resists every node that moves alone; solving for them directly makes it
/// fast.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/contact/contact_islands.hpp"
#include "host/simulate/contact/elastic_space.hpp"
#include "host/simulate/stepper.hpp"

namespace tetwarp {

/// The rows of a coupling island and its coarse unknowns.
struct CoarseIsland {
  std::int32_t row_begin = 0, row_end = 0;
  std::int32_t mode_begin = 0, mode_count = 0;  ///< 0: without coarse unknowns
  std::int64_t inverse_begin = 0;               ///< of its matrix in CoarseSpace::inverse()
  bool is_coupled = true;                       ///< false: a single rigid body
  std::int32_t elastic = -1;                    ///< place in ElasticSpace::bodies(), or -1
};

/// What a row is of its island's modes: v = sum over k of factor[k] c[first + 3 k ... + 3].
struct CoarseRow {
  std::int32_t first = 0, count = 0;
  double factor[4] = {};
};

/// Modes of an island: twelve of each deformable body (four polynomials of degree 0 and 1 that are
/// orthonormal over the nodes with unknowns, in three directions), six of each rigid one. An island
/// of a single rigid body has none, nor has one with more than `most_modes` or one of ElasticSpace.
class CoarseSpace {
 public:
  static constexpr std::int32_t most_modes = 192;

  explicit CoarseSpace(const Model& model);

  /// Sets the islands that are taken, their modes Z and the inverses of Z^T A Z.
  void set(const StepSystem& system,
           const ModelState& state,
           const ContactIslands& islands,
           const std::vector<std::uint8_t>& takes,
           const ElasticSpace& elastic,
           int threads);

  const std::vector<CoarseIsland>& islands() const { return islands_; }
  const std::vector<double>& inverse() const { return inverse_; }
  const CoarseRow& row(std::int64_t row) const { return rows_[static_cast<std::size_t>(row)]; }
  /// Place in islands() of the island of each row with unknowns, or -1.
  std::int32_t island_of_row(std::int64_t row) const {
    return island_of_row_[static_cast<std::size_t>(row)];
  }
  std::int32_t mode_count() const { return mode_count_; }

 private:
  void list_islands(const SystemRows& rows,
                    const ContactIslands& islands,
                    const std::vector<std::uint8_t>& takes,
                    const ElasticSpace& elastic);
  void set_rows(const SystemRows& rows, const ModelState& state, CoarseIsland& island);
  void set_inverse(const StepSystem& system, const CoarseIsland& island);

  const Model& model_;
  std::vector<std::int32_t> body_of_;  ///< [block_count]
  std::vector<std::int32_t> slot_of_;  ///< [bodies] first mode of the body in its island, or -1
  std::vector<CoarseIsland> islands_;
  std::vector<CoarseRow> rows_;
  std::vector<std::int32_t> island_of_row_;
  std::vector<double> inverse_;
  std::int32_t mode_count_ = 0;
};

}  // namespace tetwarp
