/// @file warp_pipeline.hpp
/// The warp as a list of stages, for any executor. Read this file first; run() is the method.
#pragma once
#include <array>
#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/pixel_dispatch.hpp"
#include "host/step_counters.hpp"
#include "host/warp_backend.hpp"
#include "host/warp_geometry.hpp"
#include "kernels/cell_cull.hpp"
#include "kernels/cell_pairs.hpp"
#include "kernels/cell_raster.hpp"
#include "kernels/corner_mask.hpp"
#include "kernels/node_quantize.hpp"
#include "kernels/tet_setup.hpp"

namespace tetwarp {

template <class Exec>
class WarpPipeline : public WarpBackend {
 public:
  WarpPipeline(const WarpPlan& plan, Exec exec)
      : plan_(plan), geometry_(make_geometry(plan)), exec_(std::move(exec)) {
    const std::int64_t tet_count = static_cast<std::int64_t>(plan_.mesh.tets.size());
    const std::int64_t node_count = static_cast<std::int64_t>(geometry_.rest.size());
    tets_ =
        exec_.resident("warp/upload", plan_.mesh.tets.front().data(), 4 * tet_count, tet_buffer_);
    rest_ = exec_.resident("warp/upload", geometry_.rest.data(), node_count, rest_buffer_);
    orientation_ = exec_.resident("warp/upload", geometry_.rest_orientation.data(), tet_count,
                                  orientation_buffer_);
    const std::size_t source_count = plan_.sources.size();
    source_buffers_.resize(source_count);
    output_buffers_.resize(source_count);
    for (std::size_t s = 0; s < source_count; ++s) upload_source(s);
    nodes_.reserve(node_count);
    setups_.reserve(tet_count);
    corner_offsets_.reserve(tet_count + 1);
    pair_offsets_.reserve(tet_count + 1);
    ranges_.reserve(geometry_.frame.cell_count());
    counters_.reserve(1);
  }

  StepReport step(const PositionsView& deformed,
                  const WarpTarget& target,
                  const Progress& progress) override {
    const auto start = std::chrono::steady_clock::now();
    exec_.use_stream(target.stream);
    const View<const double> positions =
        deformed.memory == Memory::device
            ? View<const double>{deformed.xyz, 3 * deformed.node_count}
            : exec_.resident("warp/upload", deformed.xyz, 3 * deformed.node_count,
                             position_buffer_);
    do {
      run(positions, target, progress);
    } while (!had_room());
    deliver(target);
    StepReport report = report_of_step();
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
    report.timings.total = passed.count();
    exec_.times().clear();
    return report;
  }

  std::string device() const override { return exec_.device(); }
  int threads() const override { return exec_.threads(); }

 private:
  /// The method: tetrahedron, corner, cell, voxel.
  void run(View<const double> positions, const WarpTarget& target, const Progress& progress) {
    const OutputFrame& frame = geometry_.frame;
    const std::int64_t tets = orientation_.size;
    exec_.zero("warp/setup", counters_.view(1));
    node_quantize(exec_, geometry_.output_index, frame.origin, positions, nodes_.view(rest_.size));
    tet_setup(exec_, tets_, nodes_.const_view(rest_.size), rest_, orientation_, frame,
              setups_.view(tets), corner_offsets_.view(tets + 1), pair_offsets_.view(tets + 1),
              {counters_.view(1).data->classes, tet_class_count});
    exec_.exclusive_scan("warp/setup", corner_offsets_.view(tets + 1));
    exec_.exclusive_scan("warp/setup", pair_offsets_.view(tets + 1));
    make_room();

    corner_mask(exec_, setups_.const_view(tets), corner_offsets_.const_view(tets + 1),
                masks_.view(corner_capacity_));
    const CullSwitches switches{plan_.options.skip.rejected_cells,
                                plan_.options.skip.accepted_cells};
    cell_cull(exec_, setups_.const_view(tets), corner_offsets_.const_view(tets + 1),
              masks_.const_view(corner_capacity_), pair_offsets_.const_view(tets + 1), switches,
              frame, candidates_.view(pair_capacity_));
    StepCounters* counters = counters_.view(1).data;
    cell_pairs(exec_, candidates_.const_view(pair_capacity_),
               {pair_offsets_.const_view(tets + 1).data + tets, 1}, frame,
               pairs_.view(pair_capacity_), {&counters->pairs, 1}, ranges_.view(frame.cell_count()),
               {&counters->accepted, 1});
    if (plan_.options.count_folded) count_folded();
    for (std::size_t s = 0; s < plan_.sources.size(); ++s) raster(s, target, progress);
  }

  void upload_source(std::size_t s) {
    const VolumeView& source = plan_.sources[s];
    const std::int64_t bytes = source.grid.voxel_count() * source.components *
                               static_cast<std::int64_t>(size_of(source.type));
    const std::byte* data = static_cast<const std::byte*>(source.data);
    sources_.push_back(source.memory == Memory::device
                           ? data
                           : exec_.resident("warp/upload", data, bytes, source_buffers_[s]).data);
  }

  /// Buffers of masks and pairs. Where a size must travel from the device, only the first step
  /// waits for it; later ones find out at their end whether they had room.
  void make_room() {
    if (!Exec::reads_are_free && pair_capacity_ > 0) return;
    read_totals();
    grow();
  }
  bool had_room() {
    if (Exec::reads_are_free) return true;
    read_totals();
    if (corner_total_ <= corner_capacity_ && pair_total_ <= pair_capacity_) return true;
    grow();
    return false;
  }
  void read_totals() {
    const std::int64_t tets = orientation_.size;
    StepCounters counters;
    exec_.read(counters_.const_view(1), &counters);
    throw_on_bad_positions(counters.classes);
    exec_.read(View<const std::int64_t>{corner_offsets_.const_view(tets + 1).data + tets, 1},
               &corner_total_);
    exec_.read(View<const std::int64_t>{pair_offsets_.const_view(tets + 1).data + tets, 1},
               &pair_total_);
    if (pair_total_ >= (std::int64_t{1} << 32) - 1) {
      throw std::invalid_argument(
          "mesh: " + std::to_string(pair_total_) +
          " pairs of tetrahedron and cell, at most 2^32 - 2 fit; compute regions of the grid");
    }
  }
  void grow() {
    // A quarter more than needed, so that a moving mesh does not come back at every step.
    const std::int64_t spare = Exec::reads_are_free ? 0 : 1;
    corner_capacity_ = corner_total_ + spare * (corner_total_ / 4 + 1024);
    pair_capacity_ = pair_total_ + spare * (pair_total_ / 4 + 1024);
    masks_.reserve(corner_capacity_);
    candidates_.reserve(pair_capacity_);
    pairs_.reserve(pair_capacity_);
  }

  void throw_on_bad_positions(const std::int64_t* classes) {
    if (classes[static_cast<int>(TetClass::bad_position)] == 0 &&
        classes[static_cast<int>(TetClass::too_large)] == 0) {
      return;
    }
    std::vector<TetSetup> setups(static_cast<std::size_t>(orientation_.size));
    exec_.read(setups_.const_view(orientation_.size), setups.data());
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

  void count_folded() {
    StepCounters* counters = counters_.view(1).data;
    exec_.for_each("warp/fold", geometry_.frame.voxel_count(),
                   VoxelFoldBody{tets_,
                                 nodes_.const_view(rest_.size),
                                 pairs_.const_view(pair_capacity_),
                                 {&counters->pairs, 1},
                                 ranges_.const_view(geometry_.frame.cell_count()),
                                 geometry_.frame,
                                 {&counters->folded, 1}});
  }

  void raster(std::size_t s, const WarpTarget& target, const Progress& progress) {
    with_pixel_type(plan_.sources[s].type, [&]<class T>(T) {
      const VolumeView& source = plan_.sources[s];
      const OutputFrame& frame = geometry_.frame;
      RasterJob<T> job;
      job.setups = setups_.const_view(orientation_.size);
      job.tets = tets_;
      job.nodes = nodes_.const_view(rest_.size);
      job.pairs = pairs_.const_view(pair_capacity_);
      job.ranges = ranges_.const_view(frame.cell_count());
      job.frame = frame;
      job.source = source_view<T>(source, sources_[s]);
      job.filter =
          plan_.options.filter == Filter::nearest ? Interpolation::nearest : Interpolation::linear;
      job.outside = geometry_.outside;
      job.background = rounded_to<T>(plan_.options.background);
      job.copy_whole_shifts = plan_.options.skip.copied_voxels;
      job.volume = static_cast<T*>(output_of(s, target));
      // The extra outputs and the counts come once, with the first source.
      job.mask = s == 0 ? mask_of(target) : nullptr;
      job.tet = s == 0 ? tet_of_target(target) : nullptr;
      job.counts = s == 0 ? &counters_.view(1).data->raster : nullptr;
      const double share = 1.0 / static_cast<double>(plan_.sources.size());
      cell_raster(exec_, job, ProgressPart{progress, static_cast<double>(s) * share, share});
    });
  }

  std::int64_t byte_count_of(std::size_t s) const {
    const VolumeView& source = plan_.sources[s];
    return geometry_.frame.voxel_count() * source.components *
           static_cast<std::int64_t>(size_of(source.type));
  }
  void* output_of(std::size_t s, const WarpTarget& target) {
    if (target.memory == Memory::device) return target.volumes[s];
    return exec_.writable(static_cast<std::byte*>(target.volumes[s]), byte_count_of(s),
                          output_buffers_[s]);
  }
  std::uint8_t* mask_of(const WarpTarget& target) {
    if (target.mask == nullptr || target.memory == Memory::device) return target.mask;
    return exec_.writable(target.mask, geometry_.frame.voxel_count(), mask_buffer_);
  }
  std::int32_t* tet_of_target(const WarpTarget& target) {
    if (target.tet == nullptr || target.memory == Memory::device) return target.tet;
    return exec_.writable(target.tet, geometry_.frame.voxel_count(), tet_output_buffer_);
  }

  void deliver(const WarpTarget& target) {
    if (target.memory == Memory::device) return;
    const std::int64_t voxels = geometry_.frame.voxel_count();
    for (std::size_t s = 0; s < plan_.sources.size(); ++s) {
      exec_.deliver("warp/download", output_buffers_[s].const_view(byte_count_of(s)),
                    static_cast<std::byte*>(target.volumes[s]));
    }
    if (target.mask != nullptr) {
      exec_.deliver("warp/download", mask_buffer_.const_view(voxels), target.mask);
    }
    if (target.tet != nullptr) {
      exec_.deliver("warp/download", tet_output_buffer_.const_view(voxels), target.tet);
    }
  }

  StepReport report_of_step() {
    StepCounters counters;
    exec_.read(counters_.const_view(1), &counters);
    return make_step_report(counters, exec_.times(), geometry_.frame, orientation_.size,
                            pair_total_);
  }

  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  WarpPlan plan_;
  WarpGeometry geometry_;
  Exec exec_;

  View<const std::int32_t> tets_;
  View<const Node> rest_;
  View<const std::int8_t> orientation_;
  std::vector<const std::byte*> sources_;

  Buffer<std::int32_t> tet_buffer_;
  Buffer<Node> rest_buffer_;
  Buffer<std::int8_t> orientation_buffer_;
  std::vector<Buffer<std::byte>> source_buffers_;
  Buffer<double> position_buffer_;
  Buffer<Node> nodes_;
  Buffer<TetSetup> setups_;
  Buffer<std::int64_t> corner_offsets_;
  Buffer<std::int64_t> pair_offsets_;
  Buffer<std::uint16_t> masks_;
  Buffer<CellPair> candidates_;
  Buffer<CellPair> pairs_;
  Buffer<CellRange> ranges_;
  Buffer<StepCounters> counters_;
  std::vector<Buffer<std::byte>> output_buffers_;
  Buffer<std::uint8_t> mask_buffer_;
  Buffer<std::int32_t> tet_output_buffer_;

  std::int64_t corner_capacity_ = 0;
  std::int64_t pair_capacity_ = 0;
  std::int64_t corner_total_ = 0;
  std::int64_t pair_total_ = 0;
};

}  // namespace tetwarp
