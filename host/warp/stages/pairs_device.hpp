/// @file pairs_device.hpp
/// The stages from node positions to the sorted (cell, tetrahedron) pairs on a device, in six
/// launches, seven for an update: sizes stay on the device.
#pragma once
#include <algorithm>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "host/warp/grid_point_masks.hpp"
#include "host/warp/stages/pair_state.hpp"
#include "kernels/warp/cell_list.hpp"
#include "kernels/warp/step_begin.hpp"

namespace tetwarp {

/// Computes pairs in lists that are larger than needed.
template <class Exec>
class DevicePairs : public PairState<Exec> {
 public:
  /// The arguments must outlive the object.
  DevicePairs(Exec& exec, const WarpPlan& plan, const WarpGeometry& geometry)
      : PairState<Exec>(exec, plan, geometry) {
    const std::int64_t tets = this->tet_count(), cells = this->cell_count();
    reserve(candidate_sums_, tets, sum_shift - 2);
    reserve(cell_sums_, cells);
    cell_counts_.reserve(cells);
    for (List& list : lists_) list.ranges.reserve(cells + 1);
    if (!options_.expert.skip.unchanged_tets) return;
    node_moved_.reserve(mesh_.node_count());
    moved_.reserve(tets);
    staying_.reserve(cells);
    for (Buffer<std::uint8_t>& touched : touched_) touched.reserve(cells);
    this->touched_in_two_.reserve(cells);
  }

  /// Runs setup and cull. The first step reads the sizes of its lists and allocates more than it
  /// needs; later steps neither wait nor allocate, and had_room() returns afterwards whether the
  /// memory sufficed. A step updates the one before unless most tetrahedra moved in that one.
  /// @throws std::invalid_argument on positions that are not finite or too far away
  void run(View<const double> positions) {
    now_ = 1 - now_;
    was_update_ = is_update_;
    const bool has_before = std::exchange(has_before_, false);
    is_update_ = has_before && !this->is_most(moved_count_);
    begin(positions, has_before);
    count(has_before);
    if (pair_capacity_ == 0) {
      this->take_totals(this->read_counters());
      grow(pair_total_);
    }
    make_list();
  }

  /// False when a list was too small for the step: it is enlarged, and the step must run again.
  /// @param counters  of the step, after all of its stages
  bool had_room(const StepCounters& counters) {
    this->take_totals(counters);
    const std::int64_t pairs = std::max(pair_total_, counters.work.merged_pairs);
    if (pairs <= pair_capacity_) return true;
    check_pair_count(pairs);
    grow(pairs);
    return false;
  }

  /// Records that the step is complete, so that the next one may be an update of it.
  void finish(const StepCounters& counters) {
    moved_count_ = counters.work.moved;
    has_before_ = options_.expert.skip.unchanged_tets;
    // In steps of an eighth: arguments of kernels that depend on it stay the same.
    const std::int64_t pairs = counters.work.merged_pairs;
    if (pairs > usual_pairs_) usual_pairs_ = pairs + pairs / 8;
  }

 private:
  using Base = PairState<Exec>;
  template <class T>
  using Buffer = typename Base::template Buffer<T>;
  using List = typename Base::List;
  using Base::exec_, Base::options_, Base::geometry_, Base::mesh_, Base::nodes_, Base::lists_,
      Base::now_, Base::node_moved_, Base::moved_, Base::touched_, Base::has_before_,
      Base::is_update_, Base::was_update_, Base::moved_count_, Base::pair_total_,
      Base::usual_pairs_;

  struct Sums {
    Buffer<std::int64_t> within, groups;
  };
  static void reserve(Sums& sums, std::int64_t count, int shift = sum_shift) {
    sums.within.reserve(count + 1);
    sums.groups.reserve(group_count(count, shift) + 1);
  }
  static GroupedSums view(const Sums& sums, std::int64_t count, int shift = sum_shift) {
    return {sums.within.view(count + 1), sums.groups.view(group_count(count, shift) + 1), count + 1,
            shift};
  }

  /// Nodes, and zeros to count from.
  void begin(View<const double> positions, bool has_before) {
    const auto& origin = geometry_.frame.origin;
    const std::int64_t kept = is_update_ ? kept_words : 0;
    const StepBeginOp op{
        {geometry_.output_index,
         {origin[0], origin[1], origin[2]},
         positions,
         nodes_[now_].view(mesh_.node_count())},
        has_before ? this->nodes_before() : View<const Node>{},
        node_moved_.view(has_before ? mesh_.node_count() : 0),
        {reinterpret_cast<std::int64_t*>(this->counters()) + kept, memory_words - kept},
        cell_counts_.view(is_update_ ? 0 : this->cell_count())};
    exec_.for_each("warp/setup", op.size(), op);
  }

  /// Setup of the tetrahedra, and the sums of their candidate pairs.
  void count(bool has_before) {
    const std::int64_t tets = this->tet_count();
    const GroupedSums sums = candidate_sums();
    const auto body = [&]<bool widens>(std::bool_constant<widens>) {
      return TetCountOp<widens>{Base::setup_body(sums.within),
                                node_moved_.const_view(has_before ? mesh_.node_count() : 0),
                                moved_.view(tets),
                                is_update_,
                                {this->counters()->spread.moved, SpreadCounts::places},
                                {&this->counters()->work.candidates, 1}};
    };
    if (this->widens_boxes()) {
      exec_.grouped_scan("warp/setup", tets, body(std::true_type{}), sums);
    } else if (mesh_.hexes.nodes.size > 0) {
      exec_.grouped_scan("warp/setup", tets, body(std::false_type{}), sums);
    } else {
      exec_.grouped_scan("warp/setup", tets, TetLanesOp{body(std::false_type{})}, sums);
    }
  }

  /// The sums of the candidate pairs of the tetrahedra, in groups for the lanes of their setup.
  GroupedSums candidate_sums() const {
    const bool shares = !this->widens_boxes() && mesh_.hexes.nodes.size == 0;
    return view(candidate_sums_, this->tet_count(), shares ? sum_shift - 2 : sum_shift);
  }

  void make_list() {
    const std::int64_t cells = this->cell_count();
    List& now = lists_[now_];
    now.size = pair_capacity_;
    const CullSwitches switches{options_.expert.skip.rejected_cells && !this->widens_boxes(),
                                options_.expert.skip.accepted_cells && !this->widens_boxes()};
    SpreadCounts& spread = this->counters()->spread;
    const auto spread_over = [](std::int64_t* places) {
      return SpreadCounter{places, SpreadCounts::places};
    };
    const StayingPairs staying = {is_update_ ? this->list_before() : PairList{}, this->moved(),
                                  staying_.view(is_update_ ? cells : 0)};
    const auto list_by = [&]<class Verdict>(const Verdict& verdict) {
      cell_list(exec_, candidate_sums(),
                CellCullOp<Verdict>{this->setups(), verdict, switches, geometry_.frame, {}},
                {candidates_.view(now.size), places_.view(now.size), cell_counts_.view(cells),
                 view(cell_sums_, cells), placed_.view(now.size)},
                staying,
                {now.pairs.view(now.size), now.ranges.view(cells + 1),
                 touched_[now_].view(is_update_ ? cells : 0), spread_over(spread.pairs),
                 spread_over(spread.accepted), spread_over(spread.touched_cells)},
                {&this->counters()->work.merged_pairs, 1});
    };
    if (this->uses_masks(switches)) {
      list_by(masks_.run(this->setups(), candidate_sums()));
    } else {
      list_by(PlaneVerdict{});
    }
  }

  /// Enlarges the lists to a quarter more than needed, so that small motions do not exceed them.
  void grow(std::int64_t pairs) {
    const std::int64_t size =
        std::max(pair_capacity_, std::min(pairs + pairs / 4 + 1024, max_pairs));
    pair_capacity_ = 0;  // until all of them have grown: an allocation may fail
    candidates_.reserve(size);
    places_.reserve(size);
    placed_.reserve(size);
    if (options_.expert.skip.grid_point_masks) masks_.reserve(this->tet_count(), size);
    for (List& list : lists_) list.pairs.reserve(size);
    pair_capacity_ = size;
  }

  Sums candidate_sums_, cell_sums_;
  Buffer<std::uint32_t> cell_counts_, staying_;
  Buffer<CellPair> candidates_, placed_;
  Buffer<std::uint32_t> places_;
  GridPointMasks<Exec> masks_{exec_};
  std::int64_t pair_capacity_ = 0;
};

}  // namespace tetwarp
