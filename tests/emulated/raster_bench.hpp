/// @file raster_bench.hpp
/// The raster stage of a small scene: by the host's rows, by the device's kernels on the emulation.
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/base/pixel_dispatch.hpp"
#include "host/warp/cpu/cell_raster_cpu.hpp"
#include "kernels/warp/sample/volume_prefilter.hpp"
#include "tests/support/stages.hpp"

#include "kernels/warp/cuda/cell_group.cuh"
#include "kernels/warp/cuda/cell_raster.cuh"

namespace tetwarp::test {

/// Parameters of a raster job.
struct RasterCase {
  std::string scene = "waved";
  PixelType type = PixelType::float32;
  int components = 1;
  Filter filter = Filter::linear;
  OutsideMap outside = {};
  bool copy_whole_shifts = true;
  std::optional<Region> region = {};
  std::optional<scenes::Scene> own = {};  ///< instead of the one that `scene` names
};

/// Outputs of a raster.
template <class T>
struct Rastered {
  std::vector<T> volume;
  std::vector<std::uint8_t> mask;
  std::vector<std::int32_t> owner;
  std::vector<std::uint16_t> cell_covered;
  RasterCounts counts = {0, 0, 0, 0};
};

template <class T>
bool is_same(const Rastered<T>& a, const Rastered<T>& b) {
  return std::memcmp(a.volume.data(), b.volume.data(), a.volume.size() * sizeof(T)) == 0 &&
         a.mask == b.mask && a.owner == b.owner && a.cell_covered == b.cell_covered &&
         a.counts.covered == b.counts.covered && a.counts.copied == b.counts.copied;
}

template <class T>
class RasterBench {
 public:
  explicit RasterBench(const RasterCase& what)
      : scene_(what.own ? *what.own : scenes::adversarial_scene(what.scene, 20)),
        source_(scenes::wavy_volume(scene_.source_grid, what.type, what.components)),
        input_(input_of(scene_, what.region)),
        exec_(2),
        arrays_(exec_),
        stages_(arrays_, input_) {
    job_ = stages_.template raster_job<T>(input_, source_);
    job_.filter = what.filter;
    job_.outside = what.outside;
    if (what.filter == Filter::bspline) prefilter();
    job_.copy_whole_shifts = what.copy_whole_shifts;
  }

  std::uint32_t max_pairs_in_a_cell() {
    std::uint32_t most = 0;
    for (const CellRange& range : arrays_.download(stages_.ranges)) {
      most = std::max(most, range.end - range.begin);
    }
    return most;
  }

  /// A third of the cells each: kept, sampled, filled with the value of a voxel.
  void mix_work() {
    const auto samples = static_cast<double>(source_.grid.voxel_count());
    for (std::int64_t cell = 0; cell < input_.frame.cell_count(); ++cell) {
      const double u = scenes::uniform(83, static_cast<std::uint64_t>(cell));
      const auto voxel = static_cast<std::int64_t>((u - 2.0 / 3) * 3 * samples);
      work_.push_back(u < 1.0 / 3 ? keep_cell : u < 2.0 / 3 ? sample_cell : voxel);
    }
    job_.cell_work = {work_.data(), input_.frame.cell_count()};
  }

  Rastered<T> by_rows() {
    return filled([&](const RasterJob<T>& job) {
      const Progress silent;
      cell_raster(exec_, job, ProgressPart{silent, 0, 1});
    });
  }

  /// Cells in groups of four, those left over by blocks of one cell.
  /// @param capacity   pairs of a block that have room
  /// @param is_packed  whether samples are read from a packed source
  Rastered<T> by_groups(int capacity = 63, bool is_packed = false) {
    const OutputFrame& frame = input_.frame;
    std::vector<std::uint32_t> general(static_cast<std::size_t>(frame.cell_count()));
    CellListCounts counts = {};
    return filled([&](RasterJob<T> job) {
      if (!has_plain_cells(job)) throw std::logic_error("the job has no plain cells");
      const dim3 groups(static_cast<unsigned>((frame.cells[0] + group_cells - 1) / group_cells),
                        static_cast<unsigned>(frame.cells[1]),
                        static_cast<unsigned>(frame.cells[2]));
      counts = {};
      const auto launch_groups = [&](auto* kernel) {
        launch(nullptr, kernel, groups, group_threads, group_bytes(capacity), job, capacity,
               general.data(), &counts.general);
      };
      if (is_packed) {
        job.packed = packed().data;
        launch_groups(cell_group_kernel<T, PackedSample<T>>);
      } else {
        launch_groups(cell_group_kernel<T, T>);
      }
      job.listed = general.data();
      job.listed_count = &counts.general;
      launch(nullptr, raster_kernel(job), dim3(3), raster_threads, 0, job);
      general_cells = counts.general;
    });
  }
  int general_cells = 0;  ///< of the last by_groups()
  std::int64_t cell_count() const { return input_.frame.cell_count(); }

  Rastered<T> by_blocks() {
    return filled([](const RasterJob<T>& job) {
      const dim3 cells(static_cast<unsigned>(job.frame.cell_count()));
      launch(nullptr, raster_kernel(job), cells, raster_threads, 0, job);
    });
  }

 private:
  View<PackedSample<T>> packed() {
    const auto packed = arrays_.template zeros<PackedSample<T>>(source_.grid.voxel_count());
    pack_source(exec_, PackSourceOp<T>{job_.source, packed});
    return packed;
  }

  void prefilter() {
    const auto size = source_.grid.voxel_count() * source_.components;
    const auto coefficients = arrays_.template zeros<ArithmeticOf<T>>(size);
    volume_prefilter(exec_, job_.source, 0, arrays_.template zeros<double>(size), coefficients);
    job_.source.coefficients = coefficients.data;
  }

  template <class Raster>
  Rastered<T> filled(Raster&& raster) {
    const auto voxels = static_cast<std::size_t>(input_.frame.voxel_count());
    Rastered<T> result;
    result.volume.assign(voxels * static_cast<std::size_t>(source_.components), T{55});
    result.mask.assign(voxels, 0xee);
    result.owner.assign(voxels, -99);
    result.cell_covered.assign(static_cast<std::size_t>(input_.frame.cell_count()), 999);
    job_.volume = result.volume.data();
    job_.mask = result.mask.data();
    job_.tet = result.owner.data();
    job_.counts = &result.counts;
    job_.cell_covered = {result.cell_covered.data(), input_.frame.cell_count()};
    raster(job_);
    return result;
  }

  scenes::Scene scene_;
  Volume source_;
  StageInput input_;
  CpuExec exec_;
  ExecArrays<CpuExec> arrays_;
  Stages<CpuExec> stages_;
  RasterJob<T> job_;
  std::vector<std::int64_t> work_;
};

}  // namespace tetwarp::test
