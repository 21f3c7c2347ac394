/// @file resample.cpp
/// resample() as a single part, and transforms of points.
#include <tetwarp/resample.hpp>

#include "host/warp/cpu/transform_links.hpp"
#include "host/warp/resample_part.hpp"

namespace tetwarp {

std::vector<Point3> transformed(const Transform& transform, std::vector<Point3> points) {
  const std::vector<TransformLink> links = links_of(transform);
  for (Point3& point : points) {
    for (const TransformLink& link : links) link.move(point.data());
  }
  return points;
}

void resample(std::span<const VolumeView> sources,
              const Transform& transform,
              const ResampleOptions& options,
              std::span<void* const> outputs,
              const Progress& progress) {
  ResamplePart whole;
  if (!sources.empty()) {
    const Grid& grid = sources.front().grid;
    whole.source.region.end = grid.dims;
    whole.output.end = options.output_grid.value_or(grid).dims;
  }
  resample_part(sources, transform, options, whole, outputs, progress);
}

Volume resample(const Volume& source, const Transform& transform, const ResampleOptions& options) {
  const VolumeView view(source);
  Volume result = make_volume(options.output_grid.value_or(source.grid), source.type,
                              source.components, source.name);
  void* const data = result.data.data();
  resample(std::span(&view, 1), transform, options, std::span(&data, 1));
  return result;
}

}  // namespace tetwarp
