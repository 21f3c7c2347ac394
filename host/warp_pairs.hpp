/// @file warp_pairs.hpp
/// From node positions to the sorted pairs of every cell, for any executor: all of them, or those
/// of the step before brought up to date where tetrahedra have moved.
#pragma once
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "host/step_counters.hpp"
#include "host/warp_backend.hpp"
#include "host/warp_geometry.hpp"
#include "kernels/cell_cull.hpp"
#include "kernels/cell_merge.hpp"
#include "kernels/cell_pairs.hpp"
#include "kernels/corner_mask.hpp"
#include "kernels/node_quantize.hpp"
#include "kernels/tet_moved.hpp"
#include "kernels/tet_setup.hpp"

namespace tetwarp {

template <class Exec>
class WarpPairs {
 public:
  /// The arguments must outlive it.
  WarpPairs(Exec& exec, const WarpPlan& plan, const WarpGeometry& geometry)
      : exec_(exec), options_(plan.options), geometry_(geometry) {
    const std::int64_t tet_count = static_cast<std::int64_t>(plan.mesh.tets.size());
    const std::int64_t node_count = static_cast<std::int64_t>(geometry.rest.size());
    tets_ = exec.resident("warp/upload", plan.mesh.tets.front().data(), 4 * tet_count, tet_buffer_);
    rest_ = exec.resident("warp/upload", geometry.rest.data(), node_count, rest_buffer_);
    orientation_ = exec.resident("warp/upload", geometry.rest_orientation.data(), tet_count,
                                 orientation_buffer_);
    setups_.reserve(tet_count);
    corner_offsets_.reserve(tet_count + 1);
    pair_offsets_.reserve(tet_count + 1);
    counters_.reserve(1);
    for (Buffer<Node>& nodes : nodes_) nodes.reserve(node_count);
  }

  /// Runs setup, mask and cull. Where a size must travel from the device, buffers are trusted: ask
  /// had_room() at the end of the step.
  /// @throws std::invalid_argument on positions that are not finite or too far away
  void run(View<const double> positions) {
    now_ = 1 - now_;
    exec_.zero("warp/setup", View<WorkCounters>{&counters().data->work, 1});
    node_quantize(exec_, geometry_.output_index, geometry_.frame.origin, positions,
                  nodes_[now_].view(rest_.size));
    is_update_ = std::exchange(has_before_, false) && update();
    if (!is_update_) make();
  }

  /// False when a buffer was too small: it has grown, the step must run again.
  bool had_room() {
    if (Exec::reads_are_free || is_update_) return true;
    read_totals();
    if (corner_total_ <= corner_capacity_ && pair_total_ <= pair_capacity_) return true;
    grow();
    return false;
  }

  /// The step is complete: the next may be an update of it.
  void finish(const StepCounters& counters) {
    pairs_before_ = is_update_ ? counters.work.merged_pairs : counters.work.pairs;
    has_before_ = options_.skip.unchanged_tets;
  }

  View<const std::int32_t> tets() const { return tets_; }
  View<const Node> rest() const { return rest_; }
  View<const TetSetup> setups() const { return setups_.const_view(tet_count()); }
  View<const Node> nodes() const { return nodes_[now_].const_view(rest_.size); }
  PairList list() const { return view_of(lists_[now_]); }
  View<StepCounters> counters() const { return counters_.view(1); }

  /// True when this step is an update; what follows is about updates only.
  bool is_update() const { return is_update_; }
  View<const Node> nodes_before() const { return nodes_[1 - now_].const_view(rest_.size); }
  PairList list_before() const { return view_of(lists_[1 - now_]); }
  /// 1 where a tetrahedron that has moved was or is in the list of a cell.
  View<const std::uint8_t> touched() const { return touched_.const_view(cell_count()); }

  std::int64_t tet_count() const { return orientation_.size; }
  std::int64_t unchanged_count() const { return is_update_ ? tet_count() - moved_count_ : 0; }
  std::int64_t candidate_count() const { return pair_total_; }

 private:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  struct List {
    Buffer<CellPair> pairs;
    Buffer<CellRange> ranges;
    std::int64_t size = 0;  ///< of the view of pairs; at least as many as there are
  };

  /// All pairs of all tetrahedra.
  void make() {
    exec_.zero("warp/setup", View<MeshCounters>{&counters().data->mesh, 1});
    const TetSetupBody setup = setup_body();
    tet_setup(exec_, tets_, nodes(), rest_, orientation_, geometry_.frame, setup.setups,
              setup.corner_counts, setup.pair_counts, setup.class_counts);
    exec_.exclusive_scan("warp/setup", setup.corner_counts);
    exec_.exclusive_scan("warp/setup", setup.pair_counts);
    if (Exec::reads_are_free || pair_capacity_ == 0) {
      read_totals();
      grow();
    }
    cull(corner_capacity_, pair_capacity_, lists_[now_]);
  }

  /// The pairs of the step before, but for those of moved tetrahedra. False when these are so many
  /// that it would save next to nothing.
  bool update() {
    const std::int64_t tets = tet_count();
    const TetSetupBody setup = setup_body();
    node_moved_.reserve(rest_.size);
    moved_.reserve(tets);
    moved_offsets_.reserve(tets + 1);
    tet_moved(exec_, tets_, nodes_before(), nodes(), setups(), node_moved_.view(rest_.size),
              moved_.view(tets), moved_offsets_.view(tets + 1), setup.class_counts);
    exec_.exclusive_scan("warp/setup", moved_offsets_.view(tets + 1));
    exec_.read(last_of(moved_offsets_), &moved_count_);
    if (moved_count_ > tets - tets / 8) return false;

    exec_.zero("warp/setup", setup.corner_counts);
    exec_.zero("warp/setup", setup.pair_counts);
    moved_tet_setup(exec_, moved_offsets_.const_view(tets + 1), moved_count_, setup);
    exec_.exclusive_scan("warp/setup", setup.corner_counts);
    exec_.exclusive_scan("warp/setup", setup.pair_counts);
    read_totals();
    cull(corner_total_, pair_total_, fresh_);

    List& now = lists_[now_];
    now.size = pairs_before_ + pair_total_;
    check_pair_count(now.size);
    now.pairs.reserve(now.size);
    now.ranges.reserve(cell_count() + 1);
    touched_.reserve(cell_count());
    cell_offsets_.reserve(cell_count() + 1);
    WorkCounters& work = counters().data->work;
    cell_merge(exec_, list_before(), view_of(fresh_), moved_.const_view(tets),
               now.pairs.view(now.size), {&work.merged_pairs, 1},
               cell_offsets_.view(cell_count() + 1), now.ranges.view(cell_count() + 1),
               touched_.view(cell_count()), {&work.touched_cells, 1});
    return true;
  }

  /// Pairs of the tetrahedra that have corners and candidates.
  void cull(std::int64_t corners, std::int64_t candidates, List& list) {
    const View<const std::int64_t> corner_offsets = corner_offsets_.const_view(tet_count() + 1);
    const View<const std::int64_t> pair_offsets = pair_offsets_.const_view(tet_count() + 1);
    const CullSwitches switches{options_.skip.rejected_cells, options_.skip.accepted_cells};
    masks_.reserve(corners);
    candidates_.reserve(candidates);
    corner_mask(exec_, setups(), corner_offsets, masks_.view(corners));
    cell_cull(exec_, setups(), corner_offsets, masks_.const_view(corners), pair_offsets, switches,
              geometry_.frame, candidates_.view(candidates));
    list.size = candidates;
    list.pairs.reserve(candidates);
    list.ranges.reserve(cell_count() + 1);
    WorkCounters& work = counters().data->work;
    cell_pairs(exec_, candidates_.const_view(candidates), last_of(pair_offsets_), geometry_.frame,
               list.pairs.view(candidates), {&work.pairs, 1}, list.ranges.view(cell_count() + 1),
               {&work.accepted, 1});
  }

  void read_totals() {
    StepCounters counters;
    exec_.read(counters_.const_view(1), &counters);
    throw_on_bad_positions(counters.mesh.classes);
    exec_.read(last_of(corner_offsets_), &corner_total_);
    exec_.read(last_of(pair_offsets_), &pair_total_);
    check_pair_count(pair_total_);
  }

  /// A quarter more than needed, so that a moving mesh does not come back at every step.
  void grow() {
    const std::int64_t spare = Exec::reads_are_free ? 0 : 1;
    corner_capacity_ = corner_total_ + spare * (corner_total_ / 4 + 1024);
    pair_capacity_ = pair_total_ + spare * (pair_total_ / 4 + 1024);
  }

  static void check_pair_count(std::int64_t count) {
    if (count < (std::int64_t{1} << 32) - 1) return;
    throw std::invalid_argument(
        "mesh: " + std::to_string(count) +
        " pairs of tetrahedron and cell, at most 2^32 - 2 fit; compute regions of the grid");
  }

  void throw_on_bad_positions(const std::int64_t* classes) {
    if (classes[static_cast<int>(TetClass::bad_position)] == 0 &&
        classes[static_cast<int>(TetClass::too_large)] == 0) {
      return;
    }
    std::vector<TetSetup> setups(static_cast<std::size_t>(tet_count()));
    exec_.read(setups_.const_view(tet_count()), setups.data());
    for (std::size_t t = 0; t < setups.size(); ++t) {
      if (setups[t].tet_class == TetClass::bad_position) {
        throw std::invalid_argument("deformed positions: a node of tetrahedron " +
                                    std::to_string(t) +
                                    " is not finite or over 2^40 voxels from the output grid");
      }
      if (setups[t].tet_class == TetClass::too_large) {
        throw std::invalid_argument("deformed positions: tetrahedron " + std::to_string(t) +
                                    " spans over 2^20 voxels; use a coarser output grid");
      }
    }
  }

  TetSetupBody setup_body() const {
    const std::int64_t tets = tet_count();
    return {tets_,
            nodes(),
            rest_,
            orientation_,
            geometry_.frame,
            setups_.view(tets),
            corner_offsets_.view(tets + 1),
            pair_offsets_.view(tets + 1),
            {counters().data->mesh.classes, tet_class_count}};
  }
  View<const std::int64_t> last_of(const Buffer<std::int64_t>& offsets) const {
    return {offsets.const_view(tet_count() + 1).data + tet_count(), 1};
  }
  PairList view_of(const List& list) const {
    return {list.pairs.const_view(list.size), list.ranges.const_view(cell_count() + 1)};
  }
  std::int64_t cell_count() const { return geometry_.frame.cell_count(); }

  Exec& exec_;
  const WarpOptions& options_;
  const WarpGeometry& geometry_;

  View<const std::int32_t> tets_;
  View<const Node> rest_;
  View<const std::int8_t> orientation_;
  Buffer<std::int32_t> tet_buffer_;
  Buffer<Node> rest_buffer_;
  Buffer<std::int8_t> orientation_buffer_;

  Buffer<TetSetup> setups_;
  Buffer<std::int64_t> corner_offsets_;
  Buffer<std::int64_t> pair_offsets_;
  Buffer<std::uint16_t> masks_;
  Buffer<CellPair> candidates_;
  Buffer<StepCounters> counters_;
  Buffer<Node> nodes_[2];  ///< of this step and the one before, in turns
  List lists_[2];
  int now_ = 0;

  Buffer<std::uint8_t> node_moved_;
  Buffer<std::uint8_t> moved_;
  Buffer<std::int64_t> moved_offsets_;
  List fresh_;  ///< of the moved tetrahedra
  Buffer<std::uint8_t> touched_;
  Buffer<std::int64_t> cell_offsets_;
  bool has_before_ = false;  ///< the step before was completed
  bool is_update_ = false;

  std::int64_t moved_count_ = 0;
  std::int64_t corner_capacity_ = 0;
  std::int64_t pair_capacity_ = 0;
  std::int64_t corner_total_ = 0;
  std::int64_t pair_total_ = 0;
  std::int64_t pairs_before_ = 0;  ///< length of the list of the step before
};

}  // namespace tetwarp
