/// @file pairs.hpp
/// The stages from node positions to the sorted (cell, tetrahedron) pairs, for any executor: from
/// scratch, or as an update of the step before where only some tetrahedra have moved.
#pragma once
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/base/warp_backend.hpp"
#include "host/warp/bad_positions.hpp"
#include "host/warp/geometry.hpp"
#include "host/warp/mesh_nodes.hpp"
#include "host/warp/step_counters.hpp"
#include "kernels/warp/cell_cull.hpp"
#include "kernels/warp/cell_merge.hpp"
#include "kernels/warp/cell_pairs.hpp"
#include "kernels/warp/node_quantize.hpp"
#include "kernels/warp/tet_moved.hpp"
#include "kernels/warp/tet_setup.hpp"
#include "kernels/warp/voxel_overlap.hpp"

namespace tetwarp {

/// Computes and holds the pairs of the current step and of the one before.
template <class Exec>
class WarpPairs {
 public:
  /// The arguments must outlive the object.
  WarpPairs(Exec& exec, const WarpPlan& plan, const WarpGeometry& geometry)
      : exec_(exec), options_(plan.options), geometry_(geometry), mesh_(exec, plan, geometry) {
    setups_.reserve(tet_count());
    corner_offsets_.reserve(tet_count() + 1);
    pair_offsets_.reserve(tet_count() + 1);
    counters_.reserve(1);
    for (Buffer<Node>& nodes : nodes_) nodes.reserve(mesh_.node_count());
  }

  /// Runs setup, mask and cull. On a device the first step reads the sizes of its lists and
  /// allocates more than it needs; later steps neither wait nor allocate, and had_room() returns
  /// afterwards whether the memory sufficed.
  /// @throws std::invalid_argument on positions that are not finite or too far away
  void run(View<const double> positions) {
    now_ = 1 - now_;
    was_update_ = is_update_;
    exec_.zero("warp/setup", View<WorkCounters>{&counters().data->work, 1});
    node_quantize(exec_, geometry_.output_index, geometry_.frame.origin, positions,
                  nodes_[now_].view(mesh_.node_count()));
    is_update_ = std::exchange(has_before_, false) && update();
    if (!is_update_) make();
  }

  /// False when a list was too small for the step: it is enlarged, and the step must run again.
  /// @param counters  of the step, after all of its stages
  bool had_room(const StepCounters& counters) {
    take_totals(counters);
    if (Exec::reads_are_free) return true;
    const std::int64_t pairs = std::max(pair_total_, counters.work.merged_pairs);
    if (corner_total_ <= corner_capacity_ && pairs <= pair_capacity_) return true;
    grow(corner_total_, pairs);
    return false;
  }

  /// Records that the step is complete, so that the next one may be an update of it.
  void finish(const StepCounters& counters) {
    pairs_before_ = is_update_ ? counters.work.merged_pairs : counters.work.pairs;
    moved_count_ = counters.work.moved;
    has_before_ = options_.skip.unchanged_tets;
  }

  View<const std::int32_t> tets() const { return mesh_.tets; }
  View<const Node> rest() const { return mesh_.rest; }
  const HexView& hexes() const { return mesh_.hexes; }
  View<const std::int8_t> rest_orientation() const { return mesh_.orientation; }
  View<const TetSetup> setups() const { return setups_.const_view(tet_count()); }
  View<const Node> nodes() const { return nodes_[now_].const_view(mesh_.node_count()); }
  PairList list() const { return view_of(lists_[now_]); }
  View<StepCounters> counters() const { return counters_.view(1); }

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
    exec_.for_each(
        "warp/cull", cell_count(),
        CellEverTouchedBody{touched(), touched_[1 - now_].const_view(cell_count()), both});
    return both;
  }

  std::int64_t tet_count() const { return mesh_.tet_count(); }
  std::int64_t unchanged_count() const { return is_update_ ? tet_count() - moved_count_ : 0; }
  std::int64_t candidate_count() const { return pair_total_; }

 private:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  struct List {
    Buffer<CellPair> pairs;
    Buffer<CellRange> ranges;
    std::int64_t size = 0;  ///< upper bound of the number of pairs
  };

  /// Computes the pairs of all tetrahedra.
  void make() {
    exec_.zero("warp/setup", View<MeshCounters>{&counters().data->mesh, 1});
    const TetSetupBody setup = setup_body();
    tet_setup(exec_, setup);
    if (keeps_totals()) tet_widen(exec_, setup, {});
    sum_up(setup, {});
    if (Exec::reads_are_free) {
      take_totals(read_counters());
      corner_capacity_ = corner_total_;
      pair_capacity_ = pair_total_;
    } else if (pair_capacity_ == 0) {
      take_totals(read_counters());
      grow(corner_total_, pair_total_);
    }
    cull(corner_capacity_, pair_capacity_, lists_[now_]);
  }

  /// Computes the pairs of moved tetrahedra only, and merges them with the others of the step
  /// before.
  /// @returns false when so many have moved that make() is as fast; nothing is done then
  bool update() {
    const std::int64_t tets = tet_count();
    const TetSetupBody setup = setup_body();
    reserve_update();
    tet_moved(exec_, mesh_.tets, nodes_before(), nodes(), setups(),
              node_moved_.view(mesh_.node_count()), moved_.view(tets),
              moved_offsets_.view(tets + 1), setup.class_counts, mesh_.hexes);
    exec_.exclusive_scan("warp/setup", moved_offsets_.view(tets + 1));
    std::int64_t max_moved = tets;
    if (Exec::reads_are_free) {
      max_moved = *last_of(moved_offsets_).data;
      if (max_moved > tets - tets / 8) return false;
    }
    exec_.zero("warp/setup", setup.corner_counts);
    exec_.zero("warp/setup", setup.pair_counts);
    moved_tet_setup(exec_, moved_offsets_.const_view(tets + 1), max_moved, setup);
    if (keeps_totals()) tet_widen(exec_, setup, moved_.const_view(tets));
    sum_up(setup, moved_offsets_.const_view(tets + 1));
    List& now = lists_[now_];
    if (Exec::reads_are_free) {
      take_totals(read_counters());
      cull(corner_total_, pair_total_, fresh_);
      now.size = pairs_before_ + pair_total_;
      check_pair_count(now.size);
    } else {
      cull(corner_capacity_, pair_capacity_, fresh_);
      now.size = pair_capacity_;
    }
    now.pairs.reserve(now.size);
    now.ranges.reserve(cell_count() + 1);
    WorkCounters& work = counters().data->work;
    cell_merge(exec_, list_before(), view_of(fresh_), moved_.const_view(tets),
               now.pairs.view(now.size), {&work.merged_pairs, 1},
               cell_offsets_.view(cell_count() + 1), now.ranges.view(cell_count() + 1),
               touched_[now_].view(cell_count()), {&work.touched_cells, 1});
    return true;
  }

  /// Turns the counts of a setup into offsets, and stores their totals in the counters.
  void sum_up(const TetSetupBody& setup, View<const std::int64_t> moved_offsets) {
    exec_.exclusive_scan("warp/setup", setup.corner_counts);
    exec_.exclusive_scan("warp/setup", setup.pair_counts);
    exec_.for_each(
        "warp/setup", 1,
        TotalsBody{
            moved_offsets, setup.corner_counts, setup.pair_counts, {&counters().data->work, 1}});
  }

  /// Pairs of the tetrahedra for which the last setup counted corners and candidates.
  /// @param corners, candidates  sizes of the lists, at least those counted
  void cull(std::int64_t corners, std::int64_t candidates, List& list) {
    const View<const std::int64_t> corner_offsets = corner_offsets_.const_view(tet_count() + 1);
    const View<const std::int64_t> pair_offsets = pair_offsets_.const_view(tet_count() + 1);
    const CullSwitches switches{options_.skip.rejected_cells && !keeps_totals(),
                                options_.skip.accepted_cells};
    masks_.reserve(corners);
    candidates_.reserve(candidates);
    cell_verdicts(exec_, setups(), corner_offsets, masks_.view(corners), pair_offsets, switches,
                  geometry_.frame, candidates_.view(candidates));
    list.size = candidates;
    list.pairs.reserve(candidates);
    list.ranges.reserve(cell_count() + 1);
    WorkCounters& work = counters().data->work;
    cell_pairs(exec_, candidates_.const_view(candidates), last_of(pair_offsets_), geometry_.frame,
               list.pairs.view(candidates), {&work.pairs, 1}, list.ranges.view(cell_count() + 1),
               {&work.accepted, 1});
  }

  StepCounters read_counters() {
    StepCounters counters;
    exec_.read(counters_.const_view(1), &counters);
    return counters;
  }
  void take_totals(const StepCounters& counters) {
    if (has_bad_positions(counters.mesh.classes)) {
      std::vector<TetSetup> setups(static_cast<std::size_t>(tet_count()));
      exec_.read(setups_.const_view(tet_count()), setups.data());
      throw_on_bad_positions(setups);
    }
    corner_total_ = counters.work.corners;
    pair_total_ = counters.work.candidates;
    check_pair_count(pair_total_);
  }

  /// Enlarges the lists to a quarter more than needed, so that small motions do not exceed them,
  /// and allocates what updates need, so that later steps do not allocate.
  void grow(std::int64_t corners, std::int64_t pairs) {
    corner_capacity_ = std::max(corner_capacity_, corners + corners / 4 + 1024);
    pair_capacity_ = std::max(pair_capacity_, std::min(pairs + pairs / 4 + 1024, max_pairs));
    for (List& list : lists_) {
      list.pairs.reserve(pair_capacity_);
      list.ranges.reserve(cell_count() + 1);
    }
    if (!options_.skip.unchanged_tets) return;
    reserve_update();
    fresh_.pairs.reserve(pair_capacity_);
    fresh_.ranges.reserve(cell_count() + 1);
    touched_in_two_.reserve(cell_count());
    exec_.reserve_scan(cell_count() + 1);
  }

  void reserve_update() {
    cell_offsets_.reserve(cell_count() + 1);
    for (Buffer<std::uint8_t>& touched : touched_) touched.reserve(cell_count());
    node_moved_.reserve(mesh_.node_count());
    moved_.reserve(tet_count());
    moved_offsets_.reserve(tet_count() + 1);
  }

  TetSetupBody setup_body() const {
    const std::int64_t tets = tet_count();
    return {mesh_.tets,
            nodes(),
            mesh_.rest,
            mesh_.orientation,
            geometry_.frame,
            setups_.view(tets),
            corner_offsets_.view(tets + 1),
            pair_offsets_.view(tets + 1),
            {counters().data->mesh.classes, tet_class_count},
            mesh_.hexes};
  }
  View<const std::int64_t> last_of(const Buffer<std::int64_t>& offsets) const {
    return {offsets.const_view(tet_count() + 1).data + tet_count(), 1};
  }
  PairList view_of(const List& list) const {
    return {list.pairs.const_view(list.size), list.ranges.const_view(cell_count() + 1)};
  }
  std::int64_t cell_count() const { return geometry_.frame.cell_count(); }
  /// With conservative intensity a cell needs every tetrahedron that touches a box of its voxels.
  bool keeps_totals() const { return options_.intensity == Intensity::conservative; }

  Exec& exec_;
  const WarpOptions& options_;
  const WarpGeometry& geometry_;

  WarpMesh<Exec> mesh_;
  Buffer<TetSetup> setups_;
  Buffer<std::int64_t> corner_offsets_, pair_offsets_;
  Buffer<std::uint16_t> masks_;
  Buffer<CellPair> candidates_;
  Buffer<StepCounters> counters_;
  Buffer<Node> nodes_[2];  ///< of this step at index now_, of the one before at 1 - now_
  List lists_[2];
  int now_ = 0;

  Buffer<std::uint8_t> node_moved_, moved_;
  Buffer<std::int64_t> moved_offsets_;
  List fresh_;                       ///< of the moved tetrahedra
  Buffer<std::uint8_t> touched_[2];  ///< as nodes_
  Buffer<std::uint8_t> touched_in_two_;
  Buffer<std::int64_t> cell_offsets_;
  bool has_before_ = false;                      ///< the step before is complete
  bool is_update_ = false, was_update_ = false;  ///< of this step and of the one before

  std::int64_t moved_count_ = 0;
  std::int64_t corner_capacity_ = 0, pair_capacity_ = 0, corner_total_ = 0, pair_total_ = 0;
  std::int64_t pairs_before_ = 0;  ///< length of the list of the step before
};

}  // namespace tetwarp
