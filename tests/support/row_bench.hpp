/// @file row_bench.hpp
/// Rasters of a scene by transforms or by the filter for labels, in rows and voxel by voxel.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <ostream>
#include <string>
#include <type_traits>
#include <vector>

#include "host/warp/cpu/cell_raster_cpu.hpp"
#include "kernels/warp/voxel_transform.hpp"
#include "tests/support/stages.hpp"

namespace tetwarp::test {

/// A raster of a scene by transforms or by the filter for labels.
struct RowCase {
  std::string scene = "waved";
  PixelType type = PixelType::float32;
  int components = 1;
  Filter filter = Filter::linear;
  Quantity reorientation = Quantity::components;
  bool averages = false;
  bool clamps = false;
  bool has_special = false;               ///< NaN, infinities and the least numbers in the source
  std::array<std::int64_t, 3> dims = {};  ///< of the source; zeros: those of the scene
  std::optional<Region> region = {};
  std::int64_t row = -1;  ///< voxels per row of the output, in place of `scene`; -1: the scene's
};

inline std::ostream& operator<<(std::ostream& out, const RowCase& what) {
  return out << what.scene << ' ' << name_of(what.type) << " x " << what.components << ", filter "
             << static_cast<int>(what.filter) << ", quantity "
             << static_cast<int>(what.reorientation) << ", averages " << what.averages;
}

/// The stages up to the raster, and a raster job, of one case.
template <class T>
class RowBench {
 public:
  explicit RowBench(const RowCase& what)
      : scene_(scene_of(what)),
        source_(scenes::wavy_volume(scene_.source_grid, what.type, what.components)),
        input_(input_of(scene_, what.region)),
        exec_(2),
        arrays_(exec_),
        stages_(arrays_, input_) {
    job_ = stages_.template raster_job<T>(input_, source_);
    job_.filter = what.filter;
    job_.copy_whole_shifts = true;
    job_.reorientation = what.reorientation;
    if (what.filter == Filter::labels) make_labels();
    if (what.has_special) add_special();
    if (what.filter != Filter::labels) make_transforms(what);
    if (what.clamps) {
      for (int c = 0; c < what.components; ++c) {
        range_.insert(range_.end(), {ArithmeticOf<T>(-0.25), ArithmeticOf<T>(0.5)});
      }
      job_.source.range = range_.data();
    }
  }

  std::vector<T> by_rows() {
    std::vector<T> volume = empty_volume();
    owner_.assign(static_cast<std::size_t>(input_.frame.voxel_count()), -1);
    job_.volume = volume.data();
    job_.tet = owner_.data();
    RasterCounts counts = {0, 0, 0, 0};
    job_.counts = &counts;
    const Progress silent;
    cell_raster(exec_, job_, ProgressPart{silent, 0, 1});
    covered_ = counts.covered;
    return volume;
  }

  /// The same by the functions of one voxel. @pre by_rows() has found the owners
  std::vector<T> by_voxels() {
    std::vector<T> volume = empty_volume();
    job_.volume = volume.data();
    const OutputFrame& frame = job_.frame;
    for (int k = frame.begin[2]; k < frame.end[2]; ++k) {
      for (int j = frame.begin[1]; j < frame.end[1]; ++j) {
        for (int i = frame.begin[0]; i < frame.end[0]; ++i) write(i, j, k);
      }
    }
    return volume;
  }

  std::int64_t covered() const { return covered_; }

 private:
  static scenes::Scene scene_of(const RowCase& what) {
    if (what.row >= 0) return scene_of_rows(what.row);
    scenes::Scene scene = scenes::adversarial_scene(what.scene, 20);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (what.dims[axis] > 0) scene.source_grid.dims[axis] = what.dims[axis];
    }
    return scene;
  }

  /// Output rows of `row` voxels, through which a waved bar runs. Of none: beside a single voxel.
  static scenes::Scene scene_of_rows(std::int64_t row) {
    const std::int64_t length = std::max<std::int64_t>(row, 1);
    scenes::Scene scene;
    scene.output_grid = scene.source_grid = scenes::unit_grid(length, 5, 6);
    scene.mesh = scenes::lattice({static_cast<int>(length / 7) + 1, 1, 1}, {-1, -1, -1},
                                 {static_cast<double>(length), 5, 6});
    scene.deformed = scenes::waved(scene.mesh.rest_positions, 0.7, 19);
    if (row == 0) scene.deformed = scenes::shifted(scene.deformed, {50, 0, 0});
    return scene;
  }

  /// Few labels in large and small patches, the least and the largest number among them.
  void make_labels() {
    auto* const samples = reinterpret_cast<T*>(source_.data.data());
    const std::array<T, 5> labels = {std::numeric_limits<T>::min(), T{3},
                                     std::numeric_limits<T>::max(), T{100}, T{7}};
    const std::int64_t nx = source_.grid.dims[0], ny = source_.grid.dims[1];
    for (std::int64_t v = 0; v < source_.grid.voxel_count(); ++v) {
      const std::int64_t patch = v % nx / 5 + v / nx % ny / 4 * 3 + v / nx / ny / 3 * 7;
      const double u = scenes::uniform(7, static_cast<std::uint64_t>(v));
      const auto speck = static_cast<std::int64_t>(50 * u);  // a tenth of the voxels
      samples[v] = labels[static_cast<std::size_t>(speck < 5 ? speck : patch % 5)];
    }
  }

  void add_special() {
    if constexpr (std::is_floating_point_v<T>) {
      using Limits = std::numeric_limits<T>;
      const std::array<T, 4> special = {Limits::quiet_NaN(), Limits::infinity(),
                                        Limits::denorm_min(), -T{0}};
      auto* const samples = reinterpret_cast<T*>(source_.data.data());
      const auto size = static_cast<std::uint64_t>(source_.data.size() / sizeof(T));
      for (std::uint64_t n = 0; n < size; n += 1 + n % 17) {
        samples[n] = special[static_cast<std::size_t>(4 * scenes::uniform(5, n))];
      }
    }
  }

  /// Any matrices, scales and numbers of parts; a fifth of the tetrahedra is plain.
  void make_transforms(const RowCase& what) {
    constexpr int parts[][3] = {{1, 1, 1}, {2, 2, 2}, {3, 1, 2}, {1, 1, 16}, {5, 5, 5}, {16, 3, 1}};
    for (std::int64_t t = 0; t < job_.setups.size; ++t) {
      VoxelTransform transform = plain_transform();
      std::uint64_t n = 40 * static_cast<std::uint64_t>(t);
      const auto next = [&] { return scenes::uniform(3, n++); };
      if (next() > 0.2) {
        transform.is_plain = false;
        transform.scale = next() < 0.5 ? 1.0 : 2 * next();
        for (auto& row : transform.matrix.at) {
          for (double& entry : row) entry = next() < 0.1 ? 0 : 2 * next() - 1;
        }
        if (what.averages) std::copy_n(parts[static_cast<int>(6 * next())], 3, transform.parts);
      }
      transforms_.push_back(transform);
    }
    job_.transforms = {transforms_.data(), job_.setups.size};
  }

  std::vector<T> empty_volume() const {
    return std::vector<T>(
        static_cast<std::size_t>(job_.frame.voxel_count() * job_.source.components), T{55});
  }

  void write(int i, int j, int k) {
    const std::int64_t voxel = job_.frame.offset_of(i, j, k);
    const std::int64_t t = owner_[static_cast<std::size_t>(voxel)];
    const int corner[3] = {i / cell_edge * cell_edge, j / cell_edge * cell_edge,
                           k / cell_edge * cell_edge};
    const CellVoxel at = {corner, i - corner[0], j - corner[1], k - corner[2], voxel};
    if (t < 0) {
      store_outside<true>(job_, at);
    } else if (has_transform(job_, t)) {
      store_transformed_voxel(job_, t, at);
    } else if (job_.setups[t].kind == MapKind::affine) {
      store_owned<true, T, ArithmeticOf<T>>(job_, t, at);
    } else {
      store_owned<true, T, double>(job_, t, at);
    }
  }

  scenes::Scene scene_;
  Volume source_;
  StageInput input_;
  CpuExec exec_;
  ExecArrays<CpuExec> arrays_;
  Stages<CpuExec> stages_;
  RasterJob<T> job_ = {};
  std::vector<VoxelTransform> transforms_;
  std::vector<ArithmeticOf<T>> range_;
  std::vector<std::int32_t> owner_;
  std::int64_t covered_ = 0;
};

}  // namespace tetwarp::test
