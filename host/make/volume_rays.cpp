/// @file volume_rays.cpp
/// Front-to-back compositing along rays.
#include "host/make/volume_rays.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "host/base/point3.hpp"
#include "host/make/clear_blocks.hpp"
#include "host/make/transfer.hpp"

namespace tetwarp {
namespace {
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double least_clear = 1e-3;  // below which a ray ends

Point3 turned(const IndexFromWorld& map, const Point3& x) {
  Point3 y{};
  for (std::size_t row = 0; row < 3; ++row) {
    const double* linear = map.linear[row];
    y[row] = linear[0] * x[0] + linear[1] * x[1] + linear[2] * x[2];
  }
  return y;
}

/// Depths between which a line is in the box of the voxels.
std::array<double, 2> range_in(const Grid& grid, const Point3& origin, const Point3& forward) {
  double enter = 0, leave = infinity;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double low = -0.5 - origin[axis];
    const double high = low + static_cast<double>(grid.dims[axis]);
    if (forward[axis] == 0) {
      if (low > 0 || high < 0) return {0, 0};
      continue;
    }
    const double a = low / forward[axis], b = high / forward[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return {enter, leave};
}
}  // namespace

VolumeRays::VolumeRays(std::span<const CastVolume> volumes, double step) {
  if (!(step > 0 && std::isfinite(step))) {
    throw std::invalid_argument("cast_volumes: step " + std::to_string(step) +
                                ", expected a number above 0");
  }
  step_ = infinity;
  for (const CastVolume& volume : volumes) {
    check_transfer(volume.colors);
    const VolumeView checked(*volume.volume);  // throws unless the samples fit the grid
    entries_.push_back({volume.volume, &volume.colors, index_from_world(checked.grid),
                        clear_blocks(*volume.volume, volume.colors)});
    for (std::size_t axis = 0; axis < 3; ++axis) {
      step_ = std::min(step_, step * step_length(checked.grid, axis));
    }
  }
}

std::vector<VolumeRays::Passage> VolumeRays::passages_of(const Point3& eye,
                                                         const Point3& ray) const {
  std::vector<Passage> passages;
  for (const Entry& entry : entries_) {
    const Point3 from = minus(eye, entry.volume->grid.origin);
    Passage passage{&entry, 0, 0, turned(entry.index_from_world, from),
                    turned(entry.index_from_world, ray)};
    const auto [enter, leave] = range_in(entry.volume->grid, passage.origin, passage.forward);
    passage.enter = enter;
    passage.leave = leave;
    if (enter < leave) passages.push_back(passage);
  }
  return passages;
}

Matter VolumeRays::matter_at(const Passage& passage, double depth) {
  const Point3 index = plus(passage.origin, times(depth, passage.forward));
  const Entry& entry = *passage.entry;
  if (entry.clear.has(index)) return {};
  return matter_of(*entry.colors, sample_at(*entry.volume, index));
}

void VolumeRays::add_piece(const std::vector<Passage>& passages,
                           double from,
                           double to,
                           double length,
                           RayColor& gathered) {
  const double middle = 0.5 * (from + to);
  Matter sum;
  for (const Passage& passage : passages) {
    if (middle < passage.enter || middle > passage.leave) continue;
    const Matter matter = matter_at(passage, middle);
    if (matter.extinction <= 0 || sum.extinction == infinity) continue;
    sum.extinction += matter.extinction;
    const double share = sum.extinction == infinity ? 1 : matter.extinction / sum.extinction;
    for (std::size_t c = 0; c < 3; ++c) {
      sum.color[c] = std::lerp(sum.color[c], matter.color[c], share);
    }
  }
  if (sum.extinction == 0) return;
  const double hidden = -std::expm1(-sum.extinction * (to - from) * length);
  for (std::size_t c = 0; c < 3; ++c) gathered.color[c] += gathered.clear * hidden * sum.color[c];
  gathered.clear *= 1 - hidden;
}

RayColor VolumeRays::cast(const Point3& eye, const Point3& ray, std::span<double> depths) const {
  const std::vector<Passage> passages = passages_of(eye, ray);
  if (passages.empty()) return {};
  const double length = norm(ray);
  std::vector<double> ends(depths.begin(), depths.end());
  for (const Passage& passage : passages) {
    ends.push_back(passage.enter);
    ends.push_back(passage.leave);
  }
  std::ranges::sort(depths);
  std::ranges::sort(ends);
  RayColor gathered, mean{{}, 0};
  std::size_t next = 0;  // of depths
  const auto end_at = [&](double depth) {
    for (; next < depths.size() && depths[next] <= depth; ++next) {
      const double share = 1 / static_cast<double>(depths.size());
      for (std::size_t c = 0; c < 3; ++c) mean.color[c] += share * gathered.color[c];
      mean.clear += share * gathered.clear;
    }
  };
  for (std::size_t e = 0; e + 1 < ends.size() && next < depths.size(); ++e) {
    end_at(ends[e]);
    const double from = ends[e], to = ends[e + 1];
    const bool is_inside = std::ranges::any_of(passages, [&](const Passage& passage) {
      return passage.enter <= from && to <= passage.leave;
    });
    if (!is_inside || !(from < to)) continue;
    const double pieces = std::ceil((to - from) * length / step_);
    const double piece = (to - from) / pieces;
    for (double p = 0; p < pieces && gathered.clear > least_clear; ++p) {
      add_piece(passages, from + p * piece, from + (p + 1) * piece, length, gathered);
    }
  }
  end_at(infinity);
  return mean;
}

}  // namespace tetwarp
