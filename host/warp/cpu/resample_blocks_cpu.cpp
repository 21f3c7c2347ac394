/// @file resample_blocks_cpu.cpp
/// Bounds of positions: an affine map of the output's voxels, and a box of what fields may add.
#include "host/warp/resample_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <variant>

#include "host/base/region_grid.hpp"
#include "host/warp/cpu/transform_links.hpp"
#include "kernels/warp/sample/volume_sample.hpp"

namespace tetwarp {
namespace {
/// Numbers along three axes, between low and high.
struct Bounds3 {
  double low[3] = {0, 0, 0};
  double high[3] = {0, 0, 0};

  void add(const Bounds3& other) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] += other.low[axis];
      high[axis] += other.high[axis];
    }
  }
  void enclose(int axis, double number) {
    low[axis] = std::min(low[axis], number);
    high[axis] = std::max(high[axis], number);
  }
};

/// The linear part of a map, of all that is between bounds.
Bounds3 turned(const IndexAffine& map, const Bounds3& bounds) {
  Bounds3 image;
  for (int row = 0; row < 3; ++row) {
    for (int axis = 0; axis < 3; ++axis) {
      const double a = map.linear[row][axis] * bounds.low[axis];
      const double b = map.linear[row][axis] * bounds.high[axis];
      image.low[row] += std::min(a, b);
      image.high[row] += std::max(a, b);
    }
  }
  return image;
}

/// Where voxels of the output are: at(voxel), and anything between bounds added [world].
struct Places {
  Region voxels;
  IndexAffine at;
  Bounds3 added;

  /// Their indices in a grid.
  Bounds3 indices_in(const Grid& grid) const {
    const IndexAffine to_index = index_map(grid), map = composed(to_index, at);
    Bounds3 box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.low[axis] = static_cast<double>(voxels.begin[axis]);
      box.high[axis] = static_cast<double>(voxels.end[axis] - 1);
    }
    Bounds3 indices = turned(map, box);
    indices.add(turned(to_index, added));
    for (int axis = 0; axis < 3; ++axis) {
      indices.low[axis] += map.offset[axis];
      indices.high[axis] += map.offset[axis];
    }
    return indices;
  }
};

/// The voxels that are read for positions between bounds, of which there is at least one.
/// @param reach  voxels that are read on either side of a position
Region window_of(const Grid& grid, const Bounds3& indices, int reach) {
  constexpr double rounding = 0.5;  // of positions, also of those far away in float32
  Region window;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto count = static_cast<double>(grid.dims[axis]);
    const double begin = std::floor(indices.low[axis] - rounding) - reach;
    const double end = std::floor(indices.high[axis] + rounding) + reach + 2;
    window.begin[axis] = static_cast<std::int64_t>(std::clamp(begin, 0.0, count - 1));
    window.end[axis] = static_cast<std::int64_t>(
        std::clamp(end, static_cast<double>(window.begin[axis] + 1), count));
  }
  return window;
}

/// Bounds of the vectors of a window, and of zero, which is beyond the grid.
template <class Number>
Bounds3 bounds_of(const Number* vectors,
                  const Region& window,
                  const std::array<std::int64_t, 3>& dims) {
  // So that sums and products of numbers that are not finite remain bounds.
  constexpr double most = 1e30;
  Bounds3 bounds;
  for (std::int64_t k = window.begin[2]; k < window.end[2]; ++k) {
    for (std::int64_t j = window.begin[1]; j < window.end[1]; ++j) {
      const Number* vector = vectors + 3 * (window.begin[0] + dims[0] * (j + dims[1] * k));
      for (std::int64_t i = window.begin[0]; i < window.end[0]; ++i, vector += 3) {
        for (int axis = 0; axis < 3; ++axis) {
          const auto number = static_cast<double>(vector[axis]);
          if (!std::isnan(number)) bounds.enclose(axis, std::clamp(number, -most, most));
        }
      }
    }
  }
  return bounds;
}

/// The links of a transform without displacements.
std::vector<SingleTransform> links_without_fields(const Transform& transform) {
  std::vector<SingleTransform> links;
  const auto add = [&](const auto& single) {
    using Link = std::decay_t<decltype(single)>;
    if constexpr (std::is_same_v<Link, DisplacementField>) {
      links.emplace_back(DisplacementField{single.grid, {}});
    } else if constexpr (!std::is_same_v<Link, TransformChain>) {
      links.emplace_back(single);
    }
  };
  if (const auto* const chain = std::get_if<TransformChain>(&transform)) {
    for (const SingleTransform& link : chain->links) std::visit(add, link);
  } else {
    std::visit(add, transform);
  }
  return links;
}
}  // namespace

ResampleBlocks::ResampleBlocks(const Grid& source,
                               const Grid& output,
                               const Transform& transform,
                               std::vector<FieldReader> fields,
                               Filter filter,
                               const PartLimits& limits)
    : source_(source),
      output_(output),
      links_(links_without_fields(transform)),
      fields_(std::move(fields)),
      reach_(reach_of(filter)),
      limits_(limits),
      left_{{{0, 0, 0}, output.dims}} {
  if (fields_.size() != links_.size()) {
    throw std::invalid_argument("fields: expected a reader of every link");
  }
}

std::optional<ResamplePart> ResampleBlocks::part_of(const Region& region) {
  ResamplePart part;
  part.output = region;
  part.fields.resize(links_.size());
  bytes_ = limits_.output_voxel * static_cast<double>(region.voxel_count());
  const auto fits = [&](const Region& window, double voxel_bytes) {
    bytes_ += voxel_bytes * static_cast<double>(window.voxel_count());
    return bytes_ <= limits_.bytes;
  };
  Places places{region, world_map(output_), {}};
  for (std::size_t n = 0; n < links_.size(); ++n) {
    if (const auto* const affine = std::get_if<AffineTransform>(&links_[n])) {
      const IndexAffine map = affine_map(*affine);
      places.at = composed(map, places.at);
      places.added = turned(map, places.added);
      continue;
    }
    if (const auto* const spline = std::get_if<BSplineTransform>(&links_[n])) {
      constexpr int reach = 2;
      const Region window = window_of(spline->grid, places.indices_in(spline->grid), reach);
      places.added.add(bounds_of(spline->coefficients.data(), window, spline->grid.dims));
      continue;
    }
    const Grid& grid = std::get<DisplacementField>(links_[n]).grid;
    FieldWindow& field = part.fields[n];
    field.region = window_of(grid, places.indices_in(grid), 1);
    if (!fits(field.region, fields_[n].voxel_bytes)) return std::nullopt;
    field.displacement.resize(3 * static_cast<std::size_t>(field.region.voxel_count()));
    fields_[n].read(field.region, field.displacement.data());
    const Grid window = grid_of_region(grid, field.region);
    places.added.add(bounds_of(field.displacement.data(), {{0, 0, 0}, window.dims}, window.dims));
  }
  part.source.region = window_of(source_, places.indices_in(source_), reach_);
  if (!fits(part.source.region, limits_.source_voxel)) return std::nullopt;
  return part;
}

bool ResampleBlocks::divide(const Region& region) {
  for (const std::size_t axis : {2, 1}) {
    const std::int64_t step = limits_.step[axis - 1];
    const std::int64_t steps = (region.end[axis] - region.begin[axis] + step - 1) / step;
    if (steps < 2) continue;
    Region low = region, high = region;
    low.end[axis] = high.begin[axis] = region.begin[axis] + steps / 2 * step;
    left_.push_back(high);
    left_.push_back(low);
    return true;
  }
  return false;
}

std::optional<ResamplePart> ResampleBlocks::next() {
  while (!left_.empty()) {
    const Region region = left_.back();
    left_.pop_back();
    if (region.voxel_count() > limits_.most_voxels && divide(region)) continue;
    if (std::optional<ResamplePart> part = part_of(region)) return part;
    if (!divide(region)) {
      throw std::invalid_argument("a part of the output exceeds the limit of memory");
    }
  }
  return std::nullopt;
}

}  // namespace tetwarp
