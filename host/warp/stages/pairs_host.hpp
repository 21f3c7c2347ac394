/// @file pairs_host.hpp
/// The stages from node positions to the sorted (cell, tetrahedron) pairs for executors whose
/// memory the host reads: from scratch, or as an update of the step before where only some
/// tetrahedra have moved.
#pragma once
#include <cstdint>
#include <utility>

#include "host/warp/grid_point_masks.hpp"
#include "host/warp/stages/pair_state.hpp"
#include "kernels/warp/tet_moved.hpp"
#include "kernels/warp/tet_widen.hpp"

namespace tetwarp {

/// Computes pairs in lists of exact size, sorted by radix.
template <class Exec>
class HostPairs : public PairState<Exec> {
 public:
  /// The arguments must outlive the object.
  HostPairs(Exec& exec, const WarpPlan& plan, const WarpGeometry& geometry)
      : PairState<Exec>(exec, plan, geometry) {
    pair_offsets_.reserve(this->tet_count() + 1);
  }

  /// Runs setup and cull, with mask between them where it is switched on.
  /// @throws std::invalid_argument on positions that are not finite or too far away
  void run(View<const double> positions) {
    now_ = 1 - now_;
    was_update_ = is_update_;
    exec_.zero("warp/setup", View<WorkCounters>{&this->counters()->work, 1});
    exec_.zero("warp/setup", View<SpreadCounts>{&this->counters()->spread, 1});
    node_quantize(exec_, geometry_.output_index, geometry_.frame.origin, positions,
                  nodes_[now_].view(mesh_.node_count()));
    is_update_ = std::exchange(has_before_, false) && update();
    if (!is_update_) make();
  }

  /// Whether the lists had room for the step: always.
  bool had_room(const StepCounters& counters) {
    this->take_totals(counters);
    return true;
  }

  /// Records that the step is complete, so that the next one may be an update of it.
  void finish(const StepCounters& counters) {
    pairs_before_ = is_update_ ? counters.work.merged_pairs : counters.work.pairs;
    moved_count_ = counters.work.moved;
    has_before_ = options_.expert.skip.unchanged_tets;
  }

 private:
  using Base = PairState<Exec>;
  template <class T>
  using Buffer = typename Base::template Buffer<T>;
  using List = typename Base::List;
  using Base::exec_, Base::options_, Base::geometry_, Base::mesh_, Base::nodes_, Base::lists_,
      Base::now_, Base::node_moved_, Base::moved_, Base::touched_, Base::has_before_,
      Base::is_update_, Base::was_update_, Base::moved_count_, Base::pair_total_;

  /// Computes the pairs of all tetrahedra.
  void make() {
    exec_.zero("warp/setup", View<MeshCounters>{&this->counters()->mesh, 1});
    const TetSetupOp setup = setup_body();
    tet_setup(exec_, setup);
    if (this->widens_boxes()) tet_widen(exec_, setup, {});
    sum_up(setup, {});
    cull(lists_[now_]);
  }

  /// Computes the pairs of moved tetrahedra only, and merges them with the others of the step
  /// before.
  /// @returns false when so many have moved that make() is as fast; nothing is done then
  bool update() {
    const std::int64_t tets = this->tet_count(), cells = this->cell_count();
    const TetSetupOp setup = setup_body();
    reserve_update();
    tet_moved(exec_, mesh_.tets, this->nodes_before(), this->nodes(), this->setups(),
              node_moved_.view(mesh_.node_count()), moved_.view(tets),
              moved_offsets_.view(tets + 1), setup.class_counts, mesh_.hexes);
    exec_.exclusive_scan("warp/setup", moved_offsets_.view(tets + 1));
    const std::int64_t moved = *last_of(moved_offsets_).data;
    if (this->is_most(moved)) return false;
    exec_.zero("warp/setup", setup.pair_counts);
    moved_tet_setup(exec_, moved_offsets_.const_view(tets + 1), moved, setup);
    if (this->widens_boxes()) tet_widen(exec_, setup, moved_.const_view(tets));
    sum_up(setup, moved_offsets_.const_view(tets + 1));
    cull(fresh_);
    List& now = lists_[now_];
    now.size = pairs_before_ + pair_total_;
    check_pair_count(now.size);
    now.pairs.reserve(now.size);
    now.ranges.reserve(cells + 1);
    CounterMemory* const counters = this->counters();
    cell_merge(exec_, this->list_before(), this->view_of(fresh_), moved_.const_view(tets),
               now.pairs.view(now.size), {&counters->work.merged_pairs, 1},
               cell_offsets_.view(cells + 1), now.ranges.view(cells + 1),
               touched_[now_].view(cells), {counters->spread.touched_cells, 1});
    return true;
  }

  /// Turns the counts of a setup into offsets, and takes their totals.
  void sum_up(const TetSetupOp& setup, View<const std::int64_t> moved_offsets) {
    exec_.exclusive_scan("warp/setup", setup.pair_counts);
    exec_.for_each("warp/setup", 1, TotalsOp{moved_offsets, setup.pair_counts, this->counters()});
    this->take_totals(this->read_counters());
  }

  /// Pairs of the tetrahedra for which the last setup counted candidates.
  void cull(List& list) {
    const std::int64_t tets = this->tet_count();
    const View<const std::int64_t> pair_offsets = pair_offsets_.const_view(tets + 1);
    const CullSwitches switches{options_.expert.skip.rejected_cells && !this->widens_boxes(),
                                options_.expert.skip.accepted_cells};
    candidates_.reserve(pair_total_);
    const auto cull_by = [&](const auto& verdict) {
      cell_cull(exec_, this->setups(), verdict, pair_offsets, switches, geometry_.frame,
                candidates_.view(pair_total_));
    };
    if (this->uses_masks(switches)) {
      masks_.reserve(tets, pair_total_);
      cull_by(masks_.run(this->setups(), pair_offsets));
    } else {
      cull_by(PlaneVerdict{});
    }
    list.size = pair_total_;
    list.pairs.reserve(list.size);
    list.ranges.reserve(this->cell_count() + 1);
    SpreadCounts& spread = this->counters()->spread;
    cell_pairs(exec_, candidates_.const_view(pair_total_), last_of(pair_offsets_), geometry_.frame,
               list.pairs.view(list.size), {spread.pairs, 1},
               list.ranges.view(this->cell_count() + 1), {spread.accepted, 1});
  }

  void reserve_update() {
    cell_offsets_.reserve(this->cell_count() + 1);
    for (Buffer<std::uint8_t>& touched : touched_) touched.reserve(this->cell_count());
    node_moved_.reserve(mesh_.node_count());
    moved_.reserve(this->tet_count());
    moved_offsets_.reserve(this->tet_count() + 1);
  }

  TetSetupOp setup_body() const {
    return Base::setup_body(pair_offsets_.view(this->tet_count() + 1));
  }
  View<const std::int64_t> last_of(const Buffer<std::int64_t>& offsets) const {
    return {offsets.const_view(this->tet_count() + 1).data + this->tet_count(), 1};
  }

  Buffer<std::int64_t> pair_offsets_;
  GridPointMasks<Exec> masks_{exec_};
  Buffer<CellPair> candidates_;
  Buffer<std::int64_t> moved_offsets_;
  List fresh_;  ///< of the moved tetrahedra
  Buffer<std::int64_t> cell_offsets_;
  std::int64_t pairs_before_ = 0;  ///< length of the list of the step before
};

}  // namespace tetwarp
