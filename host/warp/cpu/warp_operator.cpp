/// @file warp_operator.cpp
/// Gathers samples for W; for its transpose, slabs of the source each take what all rows of the
/// output give them, in the order of the rows.
#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <tetwarp/warp_operator.hpp>

#include "host/base/parallel.hpp"
#include "host/base/point3.hpp"
#include "host/exec/exec_cpu.hpp"
#include "host/warp/cpu/operator_plan.hpp"
#include "host/warp/cpu/operator_taps.hpp"
#include "host/warp/cpu/overlap_weights.hpp"
#include "host/warp/cpu/voxel_places.hpp"
#include "kernels/warp/sample/volume_prefilter.hpp"

namespace tetwarp {
namespace {
/// Voxels [begin, end) of the source, whole layers.
struct VoxelRange {
  std::int64_t begin = 0;
  std::int64_t end = std::numeric_limits<std::int64_t>::max();

  bool contains(std::int64_t voxel) const { return voxel >= begin && voxel < end; }
};

/// Calls visit(voxel, weight) for what a voxel of the output reads within a range.
template <class Visit>
void for_samples(const OperatorTaps& taps, const VoxelRange& range, const Visit& visit) {
  for (int z = 0; z < taps.count[2]; ++z) {
    if (!range.contains(taps.offset[2][z])) continue;
    for (int y = 0; y < taps.count[1]; ++y) {
      const std::int64_t line = taps.offset[2][z] + taps.offset[1][y];
      const double across = taps.weight[2][z] * taps.weight[1][y];
      for (int x = 0; x < taps.count[0]; ++x) {
        visit(line + taps.offset[0][x], across * taps.weight[0][x]);
      }
    }
  }
}

template <class Visit>
void for_samples(std::span<const OverlapShare> shares,
                 const VoxelRange& range,
                 const Visit& visit) {
  for (const OverlapShare& share : shares) {
    if (range.contains(share.voxel)) visit(share.voxel, share.weight);
  }
}

/// The gradient by the position of the sum over components of value times interpolated sample.
Point3 sample_gradient(const OperatorTaps& taps,
                       const double* samples,
                       const double* values,
                       int components) {
  Point3 gradient{0, 0, 0};
  for (int z = 0; z < taps.count[2]; ++z) {
    for (int y = 0; y < taps.count[1]; ++y) {
      const std::int64_t line = taps.offset[2][z] + taps.offset[1][y];
      const double wz = taps.weight[2][z], wy = taps.weight[1][y];
      double along = 0, steep = 0;
      for (int x = 0; x < taps.count[0]; ++x) {
        const double* const at = samples + (line + taps.offset[0][x]) * components;
        double sum = 0;
        for (int c = 0; c < components; ++c) sum += values[c] * at[c];
        along += taps.weight[0][x] * sum;
        steep += taps.slope[0][x] * sum;
      }
      gradient[0] += wz * wy * steep;
      gradient[1] += wz * taps.slope[1][y] * along;
      gradient[2] += taps.slope[2][z] * wy * along;
    }
  }
  return gradient;
}

/// The transpose of a matrix times a vector.
Point3 times_transposed(const Matrix3& a, const Point3& x) {
  Point3 result;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    result[axis] = a.at[0][axis] * x[0] + a.at[1][axis] * x[1] + a.at[2][axis] * x[2];
  }
  return result;
}

/// Coefficients of the spline through samples.
std::vector<double> prefiltered(std::span<const double> samples,
                                const Grid& grid,
                                int components,
                                int threads) {
  std::vector<double> work(samples.size());
  const View<double> view{work.data(), std::ssize(work)};
  SourceView<double> source = {};
  source.data = samples.data();
  source.components = components;
  for (std::size_t axis = 0; axis < 3; ++axis)
    source.dims[axis] = static_cast<int>(grid.dims[axis]);
  CpuExec exec(threads, StageClocks::off);
  volume_prefilter(exec, source, 0.0, view, view);
  return work;
}

/// Multiplies samples at the ends of every axis of more than one voxel by a factor.
void scale_ends(std::span<double> samples, const Grid& grid, int components, double factor) {
  std::int64_t stride = components;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t n = grid.dims[axis];
    for (std::int64_t layer = 0; n > 1 && layer < std::ssize(samples); layer += stride * n) {
      for (std::int64_t s = layer; s < layer + stride; ++s) {
        samples[static_cast<std::size_t>(s)] *= factor;
        samples[static_cast<std::size_t>(s + (n - 1) * stride)] *= factor;
      }
    }
    stride *= n;
  }
}

int components_of(std::span<const double> samples, const Grid& grid, const char* name) {
  const std::int64_t voxels = grid.voxel_count(), size = std::ssize(samples);
  if (size == 0 || size % voxels != 0 || size / voxels > std::numeric_limits<int>::max()) {
    throw std::invalid_argument(std::string(name) + ": expected a multiple of " +
                                std::to_string(voxels) + " samples, got " + std::to_string(size));
  }
  return static_cast<int>(size / voxels);
}
}  // namespace

struct WarpOperator::State {
  /// Layers of the source that a row of the output reads: [first, last], none: last < first.
  struct LayerRange {
    std::int32_t first = std::numeric_limits<std::int32_t>::max();
    std::int32_t last = -1;

    void include(std::int64_t layer) {
      first = std::min(first, static_cast<std::int32_t>(layer));
      last = std::max(last, static_cast<std::int32_t>(layer));
    }
    void include(const OperatorTaps& taps, std::int64_t slice) {
      for (int z = 0; z < taps.count[2]; ++z) include(taps.offset[2][z] / slice);
    }
    void include(std::span<const OverlapShare> shares, std::int64_t slice) {
      for (const OverlapShare& share : shares) include(share.voxel / slice);
    }
  };

  State(const WarpPlan& plan,
        const std::vector<Point3>& deformed,
        const WarpOperatorOptions& options)
      : filter(options.filter),
        threads(thread_count(options.threads)),
        source(plan.sources.front().grid),
        output(plan.output_grid) {
    if (deformed.size() != plan.mesh.rest_positions.size()) {
      throw std::invalid_argument("deformed: expected " +
                                  std::to_string(plan.mesh.rest_positions.size()) +
                                  " nodes as at rest, got " + std::to_string(deformed.size()));
    }
    if (options.intensity == Intensity::conservative) {
      shares.emplace(plan, deformed, options.mask, threads);
    } else {
      places.emplace(plan, deformed, options.mask, threads);
    }
    layers.resize(static_cast<std::size_t>(row_count()));
    parallel_for(threads, row_count(), [&](std::int64_t row) {
      LayerRange range;
      for_weights(
          row, [&](std::int64_t, const auto& weights) { range.include(weights, slice_voxels()); });
      layers[static_cast<std::size_t>(row)] = range;
    });
  }

  std::int64_t row_count() const { return output.dims[1] * output.dims[2]; }
  std::int64_t slice_voxels() const { return source.dims[0] * source.dims[1]; }
  bool has_coefficients() const { return places && filter == Filter::bspline; }

  /// Calls visit(voxel, weights) for the voxels of a row of the output whose row of W is not zero,
  /// with OperatorTaps or the shares of the voxel.
  template <class Visit>
  void for_weights(std::int64_t row, const Visit& visit) const {
    if (shares) return shares->for_row(row, visit);
    OperatorTaps taps;
    places->for_row(row, [&](std::int64_t voxel, const SourcePlace& place) {
      if (set_taps(source.dims, filter, place, taps)) visit(voxel, taps);
    });
  }

  /// @returns the number of components @throws std::invalid_argument
  int check_sizes(std::span<const double> x, std::span<const double> y) const {
    const int components = components_of(x, source, "x");
    if (components_of(y, output, "y") != components) {
      throw std::invalid_argument("y: expected " + std::to_string(components) +
                                  " components as x has, got " +
                                  std::to_string(std::ssize(y) / output.voxel_count()));
    }
    return components;
  }

  /// What the taps are applied to: the samples, or the coefficients of their spline, in `memory`.
  const double* tapped(std::span<const double> x,
                       int components,
                       std::vector<double>& memory) const {
    if (!has_coefficients()) return x.data();
    memory = prefiltered(x, source, components, threads);
    return memory.data();
  }

  Filter filter;
  int threads;
  Grid source, output;
  std::optional<VoxelPlaces> places;     ///< of filters
  std::optional<OverlapWeights> shares;  ///< of Intensity::conservative
  std::vector<LayerRange> layers;        ///< per row of the output
};

WarpOperator::WarpOperator(const Grid& source,
                           const Mesh& mesh,
                           const std::vector<Point3>& deformed,
                           const WarpOperatorOptions& options)
    : state_(std::make_unique<State>(operator_plan(source, mesh, options), deformed, options)) {}

WarpOperator::WarpOperator(WarpOperator&&) noexcept = default;
WarpOperator& WarpOperator::operator=(WarpOperator&&) noexcept = default;
WarpOperator::~WarpOperator() = default;

const Grid& WarpOperator::source_grid() const {
  return state_->source;
}

const Grid& WarpOperator::output_grid() const {
  return state_->output;
}

std::vector<std::uint8_t> WarpOperator::support() const {
  std::vector<std::uint8_t> marks(static_cast<std::size_t>(output_grid().voxel_count()));
  parallel_for(state_->threads, state_->row_count(), [&](std::int64_t row) {
    state_->for_weights(
        row, [&](std::int64_t voxel, const auto&) { marks[static_cast<std::size_t>(voxel)] = 1; });
  });
  return marks;
}

void WarpOperator::forward(std::span<const double> x, std::span<double> y) const {
  const int components = state_->check_sizes(x, y);
  std::vector<double> memory;
  const double* const samples = state_->tapped(x, components, memory);
  const std::int64_t row_size = output_grid().dims[0] * components;
  parallel_for(state_->threads, state_->row_count(), [&](std::int64_t row) {
    std::fill_n(y.data() + row * row_size, row_size, 0.0);
    state_->for_weights(row, [&](std::int64_t voxel, const auto& weights) {
      double* const sums = y.data() + voxel * components;
      for_samples(weights, {}, [&](std::int64_t read, double weight) {
        const double* const at = samples + read * components;
        for (int c = 0; c < components; ++c) sums[c] += weight * at[c];
      });
    });
  });
}

void WarpOperator::adjoint(std::span<const double> y, std::span<double> x) const {
  const int components = state_->check_sizes(x, y);
  const std::int64_t layer_count = source_grid().dims[2], slice = state_->slice_voxels();
  const std::int64_t slabs = std::min<std::int64_t>(layer_count, 4 * state_->threads);
  parallel_tasks(state_->threads, slabs, [&](std::int64_t slab) {
    const std::int64_t begin = layer_count * slab / slabs, end = layer_count * (slab + 1) / slabs;
    std::fill(x.data() + begin * slice * components, x.data() + end * slice * components, 0.0);
    for (std::int64_t row = 0; row < state_->row_count(); ++row) {
      const State::LayerRange& range = state_->layers[static_cast<std::size_t>(row)];
      if (range.last < begin || range.first >= end) continue;
      state_->for_weights(row, [&](std::int64_t voxel, const auto& weights) {
        const double* const values = y.data() + voxel * components;
        for_samples(weights, {begin * slice, end * slice}, [&](std::int64_t read, double weight) {
          double* const at = x.data() + read * components;
          for (int c = 0; c < components; ++c) at[c] += weight * values[c];
        });
      });
    }
  });
  if (!state_->has_coefficients()) return;
  // Coefficients are P s, and with D = 1/2 at the ends of an axis, 1 elsewhere, P^T = D P D^-1:
  // P^-1 is symmetric after its first and last row are halved.
  scale_ends(x, source_grid(), components, 2.0);
  std::ranges::copy(prefiltered(x, source_grid(), components, state_->threads), x.begin());
  scale_ends(x, source_grid(), components, 0.5);
}

std::vector<Point3> WarpOperator::node_gradient(std::span<const double> x,
                                                std::span<const double> y) const {
  const int components = state_->check_sizes(x, y);
  if (!state_->places) {
    throw std::invalid_argument(
        "node_gradient: conservative shares have no derivatives; choose intensity value");
  }
  if (state_->filter == Filter::nearest) {
    throw std::invalid_argument(
        "node_gradient: filter nearest has no slope; choose linear, cubic, bspline or lanczos");
  }
  std::vector<double> memory;
  const double* const samples = state_->tapped(x, components, memory);
  const VoxelPlaces& places = *state_->places;
  // Per tetrahedron and node of its cell, by output index; summed below in the order of tetrahedra.
  std::vector<std::array<Point3, 8>> parts(static_cast<std::size_t>(places.tet_count()));
  parallel_for(state_->threads, places.tet_count(), [&](std::int64_t t) {
    std::array<Point3, 8>& part = parts[static_cast<std::size_t>(t)];
    part.fill({0, 0, 0});
    OperatorTaps taps;
    places.for_tet(
        t, [&](std::int64_t voxel, const SourcePlace& place, const VoxelPlaces::Dependence& by) {
          if (!set_taps(source_grid().dims, state_->filter, place, taps)) return;
          const Point3 by_source =
              sample_gradient(taps, samples, y.data() + voxel * components, components);
          const Point3 by_output = times_transposed(by.backward, by_source);
          for (std::size_t a = 0; a < by.count; ++a) {
            part[a] = minus(part[a], times(by.weight[a], by_output));
          }
        });
  });
  std::vector<Point3> gradient(static_cast<std::size_t>(places.node_count()), Point3{0, 0, 0});
  const Matrix3 to_index = places.index_from_world();
  for (std::int64_t t = 0; t < places.tet_count(); ++t) {
    for (std::size_t a = 0; a < places.nodes_of(t).size(); ++a) {
      const Point3& part = parts[static_cast<std::size_t>(t)][a];
      Point3& of_node = gradient[static_cast<std::size_t>(places.nodes_of(t)[a])];
      of_node = plus(of_node, times_transposed(to_index, part));
    }
  }
  return gradient;
}

}  // namespace tetwarp
