/// @file touching_sweep.hpp
/// A sweep of projected Gauss-Seidel over the contacts of a two-level iteration.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "host/simulate/solve/two_level/elastic_groups.hpp"
#include "host/simulate/solve/two_level/elastic_space.hpp"
#include "host/simulate/solve/two_level/group_matrices.hpp"
#include "host/simulate/solve/two_level/packed_contacts.hpp"
#include "host/simulate/solve/two_level/touching_blocks.hpp"

namespace tetwarp {

/// Visits contacts in groups that act on the same elastic bodies (ElasticGroups).
class TouchingSweep {
 public:
  /// @param blocks  kept by the caller
  TouchingSweep(const TouchingBlocks& blocks, ContactSwitches switches, int threads)
      : blocks_(blocks), switches_(switches), threads_(threads) {}
  TouchingSweep(const TouchingSweep&) = delete;
  TouchingSweep& operator=(const TouchingSweep&) = delete;

  /// Forgets all groups; call after TouchingBlocks::set().
  void set(const ElasticSpace& elastic);
  /// Prepares sweeps over the contacts of a list, and sorts it into the order of sweeps.
  void begin(std::vector<std::int32_t>& working);

  /// Groups, and that of a contact, since begin().
  std::int32_t group_count() const { return groups_.count(); }
  std::int32_t group_of(std::int32_t contact) const {
    return groups_.of_contact(static_cast<std::size_t>(contact));
  }

  /// One group after the other, but those with a matrix (GroupMatrices) two at a time, each from
  /// the velocities before both. For two blocks of a symmetric positive definite matrix such sweeps
  /// converge, too. Small groups are swept several times.
  /// @param list     of the contacts of begin(), in their order
  /// @param y        in and out, as TouchingBlocks has it
  /// @param impulse  in and out, [3 list]
  void run(const std::vector<std::int32_t>& list, double* y, double* impulse);
  /// Multiplications of all sweeps since set().
  std::int64_t operations() const { return operations_; }
  /// Places of y that impulses of contacts change, ascending; of contacts that have been swept.
  void list_moved(const std::vector<std::int32_t>& list, std::vector<std::int64_t>& places);

 private:
  /// A range that is swept by its matrix.
  struct MatrixRange {
    GroupRange range;
    std::int64_t operations = 0;
  };

  int passes_over(std::int32_t group, std::size_t contacts, std::size_t all) const;
  void run_pair(std::size_t first,
                const std::vector<std::int32_t>& list,
                double* y,
                double* impulse);

  const TouchingBlocks& blocks_;
  ContactSwitches switches_;
  int threads_;
  ElasticGroups groups_;
  GroupMatrices matrices_{blocks_, groups_};
  PackedContacts packed_{blocks_, groups_};
  std::vector<MatrixRange> ranges_;  ///< of the present sweep
  std::vector<std::array<std::int64_t, 2>> moved_;
  std::int64_t operations_ = 0;
};

}  // namespace tetwarp
