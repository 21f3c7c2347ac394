/// @file group_matrices.hpp
/// Sweeps over groups of contacts whose velocities depend on their impulses by a dense matrix.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/simulate/solve/two_level/elastic_groups.hpp"
#include "host/simulate/solve/two_level/group_range.hpp"
#include "host/simulate/solve/two_level/touching_blocks.hpp"

namespace tetwarp {

/// Groups whose contacts move nodes of elastic bodies alone, and few enough of these, have a matrix
/// J M^-1 J^T: an impulse then changes the velocities of the contacts of its group instead of those
/// of nodes.
class GroupMatrices {
 public:
  /// @param blocks, groups  kept by the caller
  GroupMatrices(const TouchingBlocks& blocks, ElasticGroups& groups)
      : blocks_(blocks), groups_(groups) {}

  /// Makes the matrices of groups that have changed.
  void make(const std::vector<std::int32_t>& changed, int threads);

  bool has(std::int32_t group) const {
    return groups_.size(group) > 0 && !groups_.is_whole(group) && groups_.is_pure(group);
  }
  /// Multiplications of sweep().
  std::int64_t operations(const GroupRange& range) const {
    return static_cast<std::int64_t>(range.size()) *
           (3 * range.passes * matrices_[static_cast<std::size_t>(range.group)].stride + 200);
  }

  /// Sweeps over the contacts of a group, and leaves the sums of their pushes to
  /// ElasticGroups::finish(). Different groups may be swept at the same time.
  /// @param y        velocities before the sweep
  /// @param impulse  in and out, [3 list]
  void sweep(ContactSwitches switches,
             const GroupRange& range,
             const std::vector<std::int32_t>& list,
             const double* y,
             double* impulse);

 private:
  /// J M^-1 J^T of the contacts of a group in float32; three columns of each contact.
  struct Matrix {
    std::int64_t stride = 0;       ///< numbers of a column, a multiple of 8
    std::vector<float> values;     ///< [3 contacts][stride]
    std::vector<double> velocity;  ///< u of its contacts, [stride]
    std::vector<double> before;    ///< impulses before a sweep, [3 contacts]
    std::vector<float> moved;      ///< z for unit impulses of two contacts, [2][3][size of z]
    std::vector<float> columns;    ///< the same, [size of z][2][4]
  };

  void make(std::int32_t group);
  static void set_entries(Matrix& matrix, std::size_t k, std::size_t m, const float* block);
  void set_velocities(const GroupRange& range,
                      const std::vector<std::int32_t>& list,
                      const double* y);
  void add_pushes(const GroupRange& range,
                  const std::vector<std::int32_t>& list,
                  const double* impulse);

  const TouchingBlocks& blocks_;
  ElasticGroups& groups_;
  std::vector<Matrix> matrices_;     ///< [groups] empty of those without one
  std::vector<std::int32_t> place_;  ///< [contacts] first column in the matrix of its group
};

}  // namespace tetwarp
