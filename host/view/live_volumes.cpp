/// @file live_volumes.cpp
/// Sources as int16, grids that follow bodies, warps.
#include "host/view/live_volumes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "host/base/pixel_dispatch.hpp"
#include "host/base/point3.hpp"

namespace tetwarp::view {
namespace {
constexpr double margin = 0.1;  // of the box, on each side

/// The first component of each voxel, with the range of its values.
Volume scaled(const Volume& volume, VolumeBody& range) {
  Volume result = make_volume(volume.grid, PixelType::int16);
  const std::span<std::int16_t> to = result.samples<std::int16_t>();
  with_pixel_type(volume.type, [&](auto tag) {
    using T = decltype(tag);
    const std::span<const T> from = volume.samples<T>();
    const auto step = static_cast<std::size_t>(volume.components);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t v = 0; v < from.size(); v += step) {
      const auto value = static_cast<double>(from[v]);
      if (!std::isfinite(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
    if (low > high) low = high = 0;  // no value is finite
    if (!(high > low)) high = low + 1;
    for (std::size_t v = 0; v < to.size(); ++v) {
      const double share = (static_cast<double>(from[v * step]) - low) / (high - low);
      to[v] = static_cast<std::int16_t>(std::isfinite(share) ? share * largest_sample : 0);
    }
    range.low = low;
    range.high = high;
  });
  return result;
}

bool lies_in(const std::vector<Point3>& points, const Grid& grid) {
  return std::ranges::all_of(points, [&](const Point3& x) {
    for (std::size_t d = 0; d < 3; ++d) {
      const double end = grid.origin[d] + grid.spacing[d] * static_cast<double>(grid.dims[d] - 1);
      if (x[d] < grid.origin[d] || x[d] > end) return false;
    }
    return true;
  });
}
}  // namespace

Grid grid_around(const std::vector<Point3>& points,
                 double least_spacing,
                 std::int64_t most_voxels) {
  const Bounds bounds = bounds_of(points);
  Grid grid;
  Point3 size{};
  for (std::size_t d = 0; d < 3; ++d) {
    size[d] = std::max((1 + 2 * margin) * (bounds.high[d] - bounds.low[d]), least_spacing);
  }
  const double volume = size[0] * size[1] * size[2];
  const double spacing =
      std::max(least_spacing, std::cbrt(volume / static_cast<double>(most_voxels)));
  for (std::size_t d = 0; d < 3; ++d) {
    grid.dims[d] = static_cast<std::int64_t>(std::ceil(size[d] / spacing)) + 1;
    grid.spacing[d] = spacing;
    const double way = spacing * static_cast<double>(grid.dims[d] - 1);
    grid.origin[d] = (bounds.low[d] + bounds.high[d] - way) / 2;
  }
  return grid;
}

std::optional<double> value_at(const VolumeFrame& frame, const VolumeBody& range, const Point3& x) {
  const Grid& grid = frame.grid;
  std::int64_t voxel = 0;
  for (std::size_t d = 3; d-- > 0;) {
    const double place = std::round((x[d] - grid.origin[d]) / grid.spacing[d]);
    if (!(place >= 0 && place < static_cast<double>(grid.dims[d]))) return std::nullopt;
    voxel = voxel * grid.dims[d] + static_cast<std::int64_t>(place);
  }
  const double share =
      static_cast<double>(frame.samples[static_cast<std::size_t>(voxel)]) / largest_sample;
  return range.low + share * (range.high - range.low);
}

std::vector<RestVolume> rest_volumes(const Simulator& simulator) {
  std::vector<RestVolume> sources;
  const std::vector<Body>& bodies = simulator.scene().bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto* image = std::get_if<ImageGeometry>(&bodies[b].geometry);
    if (image == nullptr || simulator.body(b).mesh.cell_count() == 0) continue;
    RestVolume& source = sources.emplace_back();
    source.body.body = b;
    source.holds_labels = bodies[b].lookup == TransferLookup::label && !bodies[b].transfer.empty();
    source.volume = scaled(image->volume, source.body);
  }
  return sources;
}

LiveVolumes::LiveVolumes(std::vector<RestVolume> sources,
                         const ViewOptions& options,
                         Backend backend)
    : sources_(std::move(sources)),
      followers_(sources_.size()),
      most_voxels_(options.voxels),
      device_(static_cast<int>(options.device)),
      threads_(static_cast<int>(options.threads)),
      backend_(backend) {
  if (!sources_.empty()) most_voxels_ /= static_cast<std::int64_t>(sources_.size());
}

void LiveVolumes::place(std::size_t volume, const VolumeNodes& nodes) {
  Follower& follower = followers_[volume];
  if (follower.warper && lies_in(nodes.places, follower.grid)) return;
  const RestVolume& source = sources_[volume];
  follower.grid =
      grid_around(nodes.places, std::ranges::min(source.volume.grid.spacing), most_voxels_);
  WarpOptions options;
  options.filter = source.holds_labels ? Filter::nearest : Filter::linear;
  options.output_grid = follower.grid;
  options.backend = backend_;
  options.device = device_;
  options.threads = threads_;
  follower.warper.emplace(source.volume, *nodes.mesh, options);
}

void LiveVolumes::warp(const std::function<VolumeNodes(std::size_t volume)>& nodes_of,
                       std::vector<VolumeFrame>& frames) {
  frames.resize(sources_.size());
  for (std::size_t v = 0; v < sources_.size(); ++v) {
    const VolumeNodes nodes = nodes_of(v);
    place(v, nodes);
    Follower& follower = followers_[v];
    frames[v].grid = follower.grid;
    frames[v].samples.resize(static_cast<std::size_t>(follower.grid.voxel_count()));
    void* const samples = frames[v].samples.data();
    follower.warper->step(nodes.view, {.volumes = {&samples, 1}});
  }
}

}  // namespace tetwarp::view
