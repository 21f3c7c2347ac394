/// @file pair_state.hpp
/// What the two ways to compute the pairs of a step have in common: the buffers of this step and of
/// the one before, and what later stages read of them.
#pragma once
#include <cstdint>
#include <vector>

#include "host/base/warp_backend.hpp"
#include "host/warp/bad_positions.hpp"
#include "host/warp/box_sums.hpp"
#include "host/warp/geometry.hpp"
#include "host/warp/stages/mesh_nodes.hpp"
#include "host/warp/step_counters.hpp"
#include "kernels/warp/cell_merge.hpp"
#include "kernels/warp/cell_pairs.hpp"
#include "kernels/warp/node_quantize.hpp"
#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {

/// Holds the pairs of the current step and of the one before.
template <class Exec>
class PairState {
 public:
  /// The arguments must outlive the object.
  PairState(Exec& exec, const WarpPlan& plan, const WarpGeometry& geometry)
      : exec_(exec), options_(plan.options), geometry_(geometry), mesh_(exec, plan, geometry) {
    setups_.reserve(tet_count());
    counters_.reserve(1);
    for (Buffer<Node>& nodes : nodes_) nodes.reserve(mesh_.node_count());
  }

  View<const std::int32_t> tets() const { return mesh_.tets; }
  View<const Node> rest() const { return mesh_.rest; }
  const HexView& hexes() const { return mesh_.hexes; }
  View<const std::int8_t> rest_orientation() const { return mesh_.orientation; }
  View<const TetSetup> setups() const { return setups_.const_view(tet_count()); }
  View<const Node> nodes() const { return nodes_[now_].const_view(mesh_.node_count()); }
  PairList list() const { return view_of(lists_[now_]); }
  /// In the executor's memory.
  CounterMemory* counters() const { return counters_.view(1).data; }

  /// True when this step is an update of the one before. The functions below require it.
  bool is_update() const { return is_update_; }
  /// True when this step, and with steps = 2 also the one before, is an update.
  bool are_updates(int steps) const { return is_update_ && (steps == 1 || was_update_); }
  /// Per tetrahedron, 1: it has moved. Size 0: not an update, all have.
  View<const std::uint8_t> moved() const { return moved_.const_view(is_update_ ? tet_count() : 0); }
  View<const Node> nodes_before() const { return nodes_[1 - now_].const_view(mesh_.node_count()); }
  PairList list_before() const { return view_of(lists_[1 - now_]); }
  /// Per cell, 1: a moved tetrahedron was or is in its list.
  View<const std::uint8_t> touched() const { return touched_[now_].const_view(cell_count()); }
  /// The same for the last `steps` steps together, all of them updates: 1 or 2.
  View<const std::uint8_t> touched_in(int steps) {
    if (steps == 1) return touched();
    touched_in_two_.reserve(cell_count());
    const View<std::uint8_t> both = touched_in_two_.view(cell_count());
    exec_.for_each("warp/cull", cell_count(),
                   CellEverTouchedOp{touched(), touched_[1 - now_].const_view(cell_count()), both});
    return both;
  }

  std::int64_t tet_count() const { return mesh_.tet_count(); }
  std::int64_t unchanged_count() const { return is_update_ ? tet_count() - moved_count_ : 0; }
  std::int64_t candidate_count() const { return pair_total_; }
  /// About the number of pairs of a step, the same in many steps; 0: not known yet.
  std::int64_t usual_pairs() const { return usual_pairs_; }

 protected:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  struct List {
    Buffer<CellPair> pairs;
    Buffer<CellRange> ranges;
    std::int64_t size = 0;  ///< upper bound of the number of pairs
  };

  StepCounters read_counters() {
    CounterMemory memory;
    exec_.get(counters_.const_view(1), &memory);
    StepCounters counters;
    for (std::int64_t k = 0; k < counter_words; ++k) {
      reinterpret_cast<std::int64_t*>(&counters)[k] = counter_word(memory, k);
    }
    return counters;
  }
  /// @throws std::invalid_argument on positions that are not finite or too far away
  void take_totals(const StepCounters& counters) {
    if (has_bad_positions(counters.mesh.classes)) {
      std::vector<TetSetup> setups(static_cast<std::size_t>(tet_count()));
      exec_.get(setups_.const_view(tet_count()), setups.data());
      throw_on_bad_positions(setups);
    }
    pair_total_ = counters.work.candidates;
    check_pair_count(pair_total_);
  }

  TetSetupOp setup_body(View<std::int64_t> pair_counts) const {
    return {mesh_.tets,      nodes(),
            mesh_.rest,      mesh_.orientation,
            geometry_.frame, setups_.view(tet_count()),
            pair_counts,     {counters()->mesh.classes, tet_class_count},
            mesh_.hexes};
  }
  PairList view_of(const List& list) const {
    return {list.pairs.const_view(list.size), list.ranges.const_view(cell_count() + 1)};
  }
  std::int64_t cell_count() const { return geometry_.frame.cell_count(); }
  /// Where voxels are sums over boxes a cell needs every tetrahedron that touches one of its boxes.
  bool widens_boxes() const { return sums_boxes(options_); }
  /// Whether pairs are culled by masks of grid points.
  bool uses_masks(const CullSwitches& switches) const {
    return options_.expert.skip.grid_point_masks && (switches.reject || switches.accept);
  }
  /// Whether a step in which so many tetrahedra move is computed faster from scratch.
  bool is_most(std::int64_t moved) const { return moved > tet_count() - tet_count() / 8; }

  Exec& exec_;
  const WarpOptions& options_;
  const WarpGeometry& geometry_;

  WarpMesh<Exec> mesh_;
  Buffer<TetSetup> setups_;
  Buffer<CounterMemory> counters_;
  Buffer<Node> nodes_[2];  ///< of this step at index now_, of the one before at 1 - now_
  List lists_[2];
  int now_ = 0;
  Buffer<std::uint8_t> node_moved_, moved_;
  Buffer<std::uint8_t> touched_[2];  ///< as nodes_
  Buffer<std::uint8_t> touched_in_two_;
  bool has_before_ = false;                      ///< the step before is complete
  bool is_update_ = false, was_update_ = false;  ///< of this step and of the one before
  std::int64_t moved_count_ = 0;
  std::int64_t pair_total_ = 0;
  std::int64_t usual_pairs_ = 0;
};

}  // namespace tetwarp
