/// @file warp_pipeline.hpp
/// The warp as a list of stages, for any executor. Start at run(), which calls them in order.
#pragma once
#include <cstdint>
#include <utility>

#include "host/base/pixel_dispatch.hpp"
#include "host/base/warp_backend.hpp"
#include "host/warp/box_sums.hpp"
#include "host/warp/geometry.hpp"
#include "host/warp/sources.hpp"
#include "host/warp/stages/cell_raster_stage.hpp"
#include "host/warp/stages/counter_totals.hpp"
#include "host/warp/stages/curves.hpp"
#include "host/warp/stages/extension.hpp"
#include "host/warp/stages/fields.hpp"
#include "host/warp/stages/label_stages.hpp"
#include "host/warp/stages/outputs.hpp"
#include "host/warp/stages/overlap_stage.hpp"
#include "host/warp/stages/pairs.hpp"
#include "host/warp/stages/roundings.hpp"
#include "host/warp/stages/step_shares.hpp"
#include "host/warp/stages/totals.hpp"
#include "host/warp/stages/transforms.hpp"
#include "kernels/warp/cell_class.hpp"
#include "kernels/warp/cell_work.hpp"
#include "kernels/warp/voxel_cells.hpp"
#include "kernels/warp/voxel_count.hpp"

namespace tetwarp {

/// The back ends cpu and cuda.
template <class Exec>
class WarpPipeline : public WarpBackend {
 public:
  WarpPipeline(const WarpPlan& plan, Exec exec)
      : plan_(plan),
        geometry_(make_geometry(plan)),
        exec_(std::move(exec)),
        pairs_(exec_, plan_, geometry_),
        outputs_(exec_, plan_, geometry_.frame),
        transforms_(exec_, plan_, geometry_),
        fields_(exec_, plan_, geometry_),
        sources_(exec_, plan_),
        totals_(exec_, plan_, geometry_),
        roundings_(exec_, plan_, geometry_),
        extension_(exec_, plan_, geometry_),
        curves_(exec_, plan_, geometry_),
        counter_totals_(exec_, geometry_.frame.cell_count()) {
    cell_covered_.reserve(geometry_.frame.cell_count());
    cell_work_.reserve(geometry_.frame.cell_count());
  }

  ~WarpPipeline() override { exec_.drain(); }

  void upload(int number, const PositionsView& deformed) override {
    [[maybe_unused]] const auto scope = exec_.enter(number);
    if (std::exchange(flights_[number].is_open, true)) exec_.times().clear();
    const std::int64_t size = 3 * deformed.node_count;
    flights_[number].has_device_positions = deformed.memory == Memory::device;
    flights_[number].positions =
        flights_[number].has_device_positions
            ? View<const double>{deformed.xyz, size}
            : exec_.upload("warp/upload", deformed.xyz, size, flights_[number].position_buffer);
  }

  void compute(int number, const WarpTarget& target, const Progress& progress) override {
    [[maybe_unused]] const auto scope = exec_.enter(number);
    Flight& flight = flights_[number];
    flight.target = target;
    flight.age = outputs_.take(target);
    flight.slot = outputs_.slot();
    flight.is_delivered = false;
    compute(flight, progress);
    // The part that an update writes is known after settle(); a whole output is downloaded now.
    if (stale_.size == 0 && target.memory == Memory::host && outputs_.downloads_async(target)) {
      flight.window = outputs_.window_of({});
      download(number);
    }
  }

  void settle(int number) override {
    [[maybe_unused]] const auto scope = exec_.enter(number);
    Flight& flight = flights_[number];
    for (;;) {
      exec_.wait_computed();
      if (pairs_.had_room(*flight.counters.view(1).data)) break;
      flight.is_delivered = false;
      compute(flight, {});
    }
    flight.report = complete(flight.target, *flight.counters.view(1).data);
    if (totals_.are_requested()) totals_.report(flight.totals, flight.report.totals);
    if (roundings_.are_requested()) {
      roundings_.report(flight.roundings, totals_.output_voxel(), flight.report);
    }
    if (flight.target.memory == Memory::host) flight.window = outputs_.window_of(stale_);
  }

  void download(int number) override {
    [[maybe_unused]] const auto scope = exec_.enter(number);
    Flight& flight = flights_[number];
    if (flight.target.memory == Memory::device || std::exchange(flight.is_delivered, true)) return;
    outputs_.download(flight.slot, flight.target, flight.window);
    exec_.end_download();
  }

  StepReport finish(int number) override {
    [[maybe_unused]] const auto scope = exec_.enter(number);
    exec_.wait_delivered();
    StageTimes& times = exec_.times();
    outputs_.release(flights_[number].slot);
    StepReport report = flights_[number].report;
    add_stages(times, report.timings);
    times.clear();
    flights_[number].is_open = false;
    return report;
  }

  void drain() noexcept override { exec_.drain(); }
  std::string device() const override { return exec_.device(); }
  int threads() const override { return exec_.threads(); }

 private:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  /// The state of a step between the calls for its parts.
  struct Flight {
    typename Exec::template Staged<double> position_buffer;
    View<const double> positions;
    bool has_device_positions = false;
    typename Exec::template PinnedBuffer<StepCounters> counters;
    typename Exec::template PinnedBuffer<double> totals;
    typename Exec::template PinnedBuffer<RoundingChange> roundings;
    WarpTarget target;
    int age = 0;          ///< see WarpOutputs::take()
    int slot = 0;         ///< of outputs_
    CellWindow window{};  ///< cells to download
    bool is_delivered = false;
    bool is_open = false;  ///< begun and not finished; stays set when the step fails
    StepReport report;
  };

  void compute(Flight& flight, const Progress& progress) {
    exec_.begin_compute(flight.target.stream, flight.has_device_positions ||
                                                  flight.target.memory == Memory::device ||
                                                  sources_.are_on_device());
    flight.counters.reserve(1);
    run(flight.positions, flight.target, flight.age, progress);
    ProgressPart{progress, 0, 1}.report(1.0);
    counter_totals_.run(pairs_.counters(), cell_covered_.const_view(stale_.size),
                        flight.counters.view(1).data);
    if (totals_.are_requested()) totals_.fetch(flight.totals);
    if (roundings_.are_requested()) roundings_.fetch(flight.roundings);
    exec_.end_compute(flight.target.memory == Memory::host);
  }

  /// All stages of a step, in order: tetrahedra, cells, voxels.
  /// @param age  of the result that the target holds [step]; 0: unknown
  void run(View<const double> positions,
           const WarpTarget& target,
           int age,
           const Progress& progress) {
    pairs_.run(positions);
    transforms_.run(pairs_);
    stale_ = {};
    // Voxels outside depend on the whole surface, those of curved cells on nodes without a pair.
    const bool are_local = !extension_.is_requested() && !curves_.are_there();
    if (age > 0 && are_local && pairs_.are_updates(age)) stale_ = pairs_.touched_in(age);
    if (plan_.options.count_folded) count_folded();
    const WarpTarget extra = outputs_.extra(target);
    const StepShares shares(plan_, extra.fields);
    for (std::size_t s = 0; s < sources_.size(); ++s) {
      raster(s, outputs_.volume(s, target), extra, shares.of_source(s, progress));
    }
    const View<std::int32_t> owners{extra.owner,
                                    extra.owner != nullptr ? geometry_.frame.voxel_count() : 0};
    fields_.run(pairs_, owners, stale_, extra.fields);
    if (curves_.are_there()) curve(target, owners, extra.fields);
    if (extension_.is_requested()) extend(target, owners, extra.fields.displacement);
    if (takes_gaussian(plan_.options)) choose_labels(target, owners);
    voxel_cells(exec_, pairs_.hexes(), geometry_.frame, stale_, owners);
  }

  /// In an update only touched cells are counted again, and their counts of the step before are
  /// subtracted.
  void count_folded() {
    const View<const std::uint8_t> touched =
        pairs_.is_update() ? pairs_.touched() : View<const std::uint8_t>{};
    const View<std::int64_t> folded{&pairs_.counters()->mesh.folded, 1};
    const auto count = [&](View<const Node> nodes, const PairList& list, std::int64_t weight) {
      const VoxelFoldOp op = {pairs_.tets(), nodes, list, touched, geometry_.frame, folded, weight};
      exec_.for_each("warp/fold", geometry_.frame.voxel_count(), op);
    };
    if (pairs_.is_update()) count(pairs_.nodes_before(), pairs_.list_before(), -1);
    count(pairs_.nodes(), pairs_.list(), 1);
  }

  /// Voxels that no tetrahedron covers, of all sources.
  void extend(const WarpTarget& target, View<const std::int32_t> owners, float* displacement) {
    extension_.run(pairs_);
    for (std::size_t s = 0; s < sources_.size(); ++s) {
      with_pixel_type(plan_.sources[s].type, [&]<class T>(T) {
        RasterJob<T> job{};
        set_samples(s, outputs_.volume(s, target), job);
        extension_.write(job, owners, s == 0 ? displacement : nullptr);
      });
    }
  }

  /// Voxels of tetrahedra of ten nodes, of all sources.
  void curve(const WarpTarget& target, View<const std::int32_t> owners, const FieldTarget& fields) {
    for (std::size_t s = 0; s < sources_.size(); ++s) {
      with_pixel_type(plan_.sources[s].type, [&]<class T>(T) {
        RasterJob<T> job{};
        set_samples(s, outputs_.volume(s, target), job);
        curves_.write(pairs_, job, owners,
                      s == 0 ? &pairs_.counters()->work.straightened : nullptr);
      });
    }
    curves_.write(pairs_, owners, fields);
  }

  /// Labels of all sources by Gaussian weights.
  void choose_labels(const WarpTarget& target, View<const std::int32_t> owners) {
    for (std::size_t s = 0; s < sources_.size(); ++s) {
      with_pixel_type(plan_.sources[s].type, [&]<class T>(T) {
        const GaussianLabels labels =
            gaussian_labels(plan_.sources[s].grid, number_view(sources_.template view<T>(s).data),
                            plan_.options.label_gaussian,
                            static_cast<double>(rounded_to<T>(plan_.options.background)));
        const HexMesh mesh = {pairs_.hexes(), pairs_.tets(), pairs_.nodes(), pairs_.rest()};
        voxel_gaussian(exec_,
                       {pairs_.setups(), mesh, owners, stale_, geometry_.frame, geometry_.outside,
                        labels, number_view(static_cast<T*>(outputs_.volume(s, target)))});
      });
    }
  }

  /// What stages need to sample source s.
  template <class T>
  void set_samples(std::size_t s, void* volume, RasterJob<T>& job) {
    job.frame = geometry_.frame;
    job.source = sources_.template view<T>(s);
    job.filter = takes_gaussian(plan_.options) ? Filter::nearest : plan_.options.filter;
    job.outside = geometry_.outside;
    job.background = rounded_to<T>(plan_.options.background);
    job.copy_whole_shifts = plan_.options.expert.skip.copied_voxels;
    job.volume = static_cast<T*>(volume);
  }

  /// Owners and samples of source s.
  /// @param volume, extra  where the executor writes samples, and with source 0 mask and owners
  void raster(std::size_t s, void* volume, const WarpTarget& extra, const ProgressPart& part) {
    with_pixel_type(plan_.sources[s].type, [&]<class T>(T) {
      const OutputFrame& frame = geometry_.frame;
      RasterJob<T> job;
      job.setups = pairs_.setups();
      job.tets = pairs_.tets();
      job.hexes = pairs_.hexes();
      job.rest = pairs_.rest();
      job.nodes = pairs_.nodes();
      job.pairs = pairs_.list().pairs;
      job.ranges = {pairs_.list().ranges.data, frame.cell_count()};
      job.usual_pairs = pairs_.usual_pairs();
      set_samples(s, volume, job);
      // Mask, owners and counts are the same for all sources.
      job.mask = s == 0 ? extra.mask : nullptr;
      job.tet = s == 0 ? extra.owner : nullptr;
      job.counts = s == 0 ? pairs_.counters()->spread.raster : nullptr;
      job.count_places = SpreadCounts::places;
      if (s == 0) job.cell_covered = cell_covered_.view(frame.cell_count());
      job.transforms = transforms_.transforms(s, pairs_.tet_count());
      job.outside_transform = transforms_.outside();
      job.reorientation = transforms_.reorientation(s);
      const bool has_groups =
          plan_.options.expert.skip.interior_cells && !sums_boxes(plan_.options);
      if constexpr (!Exec::reads_are_free && can_blend<T> && sizeof(ArithmeticOf<T>) == 4) {
        if (has_groups && has_plain_cells(job)) {
          job.packed = sources_.packed(s, job.source);
        }
      }
      const CellWorkOp<T> work = work_of_cells(s, job);
      if (sums_boxes(plan_.options)) {
        cell_work(exec_, work);
        sum_boxes(s, work.job, part);
      } else {
        cell_raster_.run(exec_, work, has_groups, s == 0 ? &pairs_.counters()->lists : nullptr,
                         part);
      }
      if (totals_.are_requested()) {
        totals_.run(s, number_view(job.source.data), number_view(job.volume), pairs_);
      }
    });
  }

  /// Sums over the voxels' boxes; for the first source after a raster of mask and owners.
  template <class T>
  void sum_boxes(std::size_t s, RasterJob<T> job, const ProgressPart& progress) {
    const BoxOverlaps boxes = {job.setups,
                               job.tets,
                               pairs_.list(),
                               job.cell_work,
                               job.frame,
                               number_view(job.source.data),
                               {job.source.dims[0], job.source.dims[1], job.source.dims[2]},
                               job.source.components};
    const NumberView volume = number_view(job.volume);
    const View<const VoxelTransform> transforms = job.transforms;
    job.filter = Filter::nearest;
    job.transforms = {};
    constexpr double raster = 0.01;  // of the time of this source
    if (s == 0) cell_raster(exec_, job, part_of(progress, 0, raster));
    const ProgressPart part = part_of(progress, s == 0 ? raster : 0, 1);
    if (takes_majority(plan_.options)) {
      majority_stage(
          exec_, {boxes, pairs_.rest_orientation(), volume, static_cast<double>(job.background)},
          part);
      return;
    }
    const VoxelOverlapOp op = {boxes, transforms, roundings_.begin(s, job.cell_work, volume)};
    overlap_.run(exec_, op, pairs_.nodes(), pairs_.rest(), voxel_ratio_of(geometry_.axes), part);
    roundings_.sum(s);
  }

  /// Finds the cells to keep and the cells to fill with one value; the others are sampled.
  template <class T>
  CellWorkOp<T> work_of_cells(std::size_t s, const RasterJob<T>& job) {
    CellWorkOp<T> op = {job, {}, stale_, {}, {}};
    const bool is_sampled = job.transforms.size == 0 && !sums_boxes(plan_.options);
    if (plan_.options.expert.skip.constant_cells && is_sampled) {
      op.uniform = sources_.uniform_map(s, job.source, pairs_.tets(), pairs_.rest());
    }
    if (stale_.size == 0 && op.uniform.reach.size == 0) return op;
    op.work = cell_work_.view(geometry_.frame.cell_count());
    op.job.cell_work = {op.work.data, op.work.size};
    op.constant_count = {pairs_.counters()->spread.constant_cells,
                         s == 0 ? SpreadCounts::places : 0};
    return op;
  }

  /// Records a computed step for the next one. @returns its report without times
  StepReport complete(const WarpTarget& target, StepCounters counters) {
    if (stale_.size == 0) counters.work.covered = counters.work.raster.covered;
    pairs_.finish(counters);
    outputs_.finish(target);
    const std::int64_t cells_unchanged =
        stale_.size > 0 ? geometry_.frame.cell_count() - counters.work.touched_cells : 0;
    return make_step_report(counters, geometry_.frame,
                            {.tets = pairs_.tet_count(),
                             .tets_unchanged = pairs_.unchanged_count(),
                             .cells_unchanged = cells_unchanged,
                             .candidate_pairs = pairs_.candidate_count()});
  }

  WarpPlan plan_;
  WarpGeometry geometry_;
  Exec exec_;
  WarpPairs<Exec> pairs_;
  WarpOutputs<Exec> outputs_;
  WarpTransforms<Exec> transforms_;
  WarpFields<Exec> fields_;
  WarpSources<Exec> sources_;
  WarpTotals<Exec> totals_;
  WarpRoundings<Exec> roundings_;
  WarpExtension<Exec> extension_;
  WarpCurves<Exec> curves_;
  CounterTotals<Exec> counter_totals_;
  CellRaster<Exec> cell_raster_;
  OverlapStage<Exec> overlap_;
  Flight flights_[2];
  Buffer<std::int64_t> cell_work_;
  Buffer<std::uint16_t> cell_covered_;  ///< covered voxels per cell; kept from step to step
  View<const std::uint8_t> stale_;      ///< per cell, 0: up to date in the target; size 0: none is
};

}  // namespace tetwarp
