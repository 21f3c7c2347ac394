/// @file isosurface.cpp
/// Samples the image on a lattice, marches its tetrahedra, and places the points.
#include "host/scene/isosurface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

#include "host/scene/image_lattice.hpp"
#include "host/scene/marching_tets.hpp"
#include "host/scene/volume_rows.hpp"

namespace tetwarp {
namespace {
/// Least distance of points from lattice nodes, in edges.
constexpr double least_distance = 0.02;

/// Nodes that cover a box of voxels: node n is at index position start + step n.
struct Sampling {
  Point3 start;
  double step;
  std::array<std::int64_t, 3> counts;

  Point3 index_of(const std::array<std::int64_t, 3>& node) const {
    return {start[0] + step * static_cast<double>(node[0]),
            start[1] + step * static_cast<double>(node[1]),
            start[2] + step * static_cast<double>(node[2])};
  }
};

/// The samples of an image minus the threshold, interpolated linearly along each axis; negative
/// more than half a voxel beyond the outermost centers.
class ImageLevel {
 public:
  ImageLevel(const ImageGeometry& image, const Region& box) : box_(box) {
    // One voxel around the foreground takes part in the interpolation.
    for (std::size_t d = 0; d < 3; ++d) {
      box_.begin[d] = std::max<std::int64_t>(box_.begin[d] - 1, 0);
      box_.end[d] = std::min(box_.end[d] + 1, image.volume.grid.dims[d]);
      low_[d] = static_cast<double>(box_.begin[d]) - 0.5;
      high_[d] = static_cast<double>(box_.end[d]) - 0.5;
    }
    levels_.reserve(static_cast<std::size_t>(box_.voxel_count()));
    VolumeRows rows(image.volume, image.threshold);
    for (std::int64_t k = box_.begin[2]; k < box_.end[2]; ++k) {
      for (std::int64_t j = box_.begin[1]; j < box_.end[1]; ++j) {
        const auto& row = rows.row(j, k);
        for (std::int64_t i = box_.begin[0]; i < box_.end[0]; ++i) {
          const double level = row[static_cast<std::size_t>(i)];
          levels_.push_back(std::isnan(level) ? -1 : level);
        }
      }
    }
  }

  /// Whether a position is at most half a voxel beyond the outermost centers.
  bool contains(const Point3& index) const {
    for (std::size_t d = 0; d < 3; ++d) {
      if (index[d] < low_[d] || index[d] > high_[d]) return false;
    }
    return true;
  }

  double operator()(const Point3& index) const {
    if (!contains(index)) return -1;
    std::array<std::int64_t, 3> base{};
    Point3 part{};
    for (std::size_t d = 0; d < 3; ++d) {
      const double inside = std::clamp(index[d], low_[d] + 0.5, high_[d] - 0.5);
      base[d] =
          std::min(static_cast<std::int64_t>(inside), std::max(box_.end[d] - 2, box_.begin[d]));
      part[d] = inside - static_cast<double>(base[d]);
    }
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      std::array<std::int64_t, 3> voxel{};
      double weight = 1;
      for (std::size_t d = 0; d < 3; ++d) {
        const bool is_far = (corner >> d & 1) != 0;
        voxel[d] = base[d] + is_far;
        weight *= is_far ? part[d] : 1 - part[d];
      }
      if (weight > 0) sum += weight * level_of_voxel(voxel);
    }
    return sum;
  }

 private:
  double level_of_voxel(const std::array<std::int64_t, 3>& voxel) const {
    const std::int64_t ni = box_.end[0] - box_.begin[0], nj = box_.end[1] - box_.begin[1];
    return levels_[static_cast<std::size_t>(
        ((voxel[2] - box_.begin[2]) * nj + voxel[1] - box_.begin[1]) * ni + voxel[0] -
        box_.begin[0])];
  }

  Region box_;
  Point3 low_, high_;
  std::vector<double> levels_;
};

/// Reads the levels of the nodes of a plane.
auto plane_reader(const ImageLevel& level, const Sampling& sampling) {
  return [&](std::int64_t c, std::vector<double>& levels) {
    std::size_t n = 0;
    for (std::int64_t b = 0; b < sampling.counts[1]; ++b) {
      for (std::int64_t a = 0; a < sampling.counts[0]; ++a) {
        levels[n++] = level(sampling.index_of({a, b, c}));
      }
    }
  };
}

MarchedSurface marched(const std::string& place,
                       const ImageLevel& level,
                       const Sampling& sampling) {
  return march_tets(place, sampling.counts, plane_reader(level, sampling));
}

/// Place between the nodes of a cut where the level changes its sign, by bisection.
double crossing(const ImageLevel& level, const Point3& inside, const Point3& outside) {
  double low = 0, high = 1;
  for (int pass = 0; pass < 40; ++pass) {
    const double t = 0.5 * (low + high);
    const Point3 x = plus(inside, times(t, minus(outside, inside)));
    (level(x) >= 0 ? low : high) = t;
  }
  return low;
}

Surface placed(MarchedSurface marched,
               const ImageGeometry& image,
               const ImageLevel& level,
               const Sampling& sampling) {
  const Grid& grid = image.volume.grid;
  Surface surface;
  surface.points.reserve(marched.cuts.size());
  for (const EdgeCut& cut : marched.cuts) {
    const Point3 inside = sampling.index_of(cut.inside), outside = sampling.index_of(cut.outside);
    // Between neighboring voxels the linear level is near enough.
    const bool is_linear = sampling.step == 1 && level.contains(outside);
    const double t = std::clamp(is_linear ? cut.t : crossing(level, inside, outside),
                                least_distance, 1 - least_distance);
    surface.points.push_back(grid.world_of(plus(inside, times(t, minus(outside, inside)))));
  }
  surface.triangles = std::move(marched.triangles);
  const auto& m = grid.direction;
  if (dot({m[0], m[1], m[2]}, cross({m[3], m[4], m[5]}, {m[6], m[7], m[8]})) < 0) {
    for (auto& triangle : surface.triangles) std::swap(triangle[1], triangle[2]);
  }
  return surface;
}

/// Nodes a step apart around the middle of a box, from outside it to outside it.
Sampling sampling_of(const Region& box, double step) {
  Sampling sampling{{}, step, {}};
  for (std::size_t d = 0; d < 3; ++d) {
    const auto extent = static_cast<double>(box.end[d] - box.begin[d]);
    const auto count = static_cast<std::int64_t>(std::ceil(extent / step)) + 2;
    const double middle = 0.5 * static_cast<double>(box.begin[d] + box.end[d] - 1);
    sampling.counts[d] = count;
    sampling.start[d] = middle - 0.5 * step * static_cast<double>(count - 1);
  }
  return sampling;
}
}  // namespace

Surface make_isosurface(const std::string& place, const ImageGeometry& image) {
  const Region box = foreground_box(place, image);
  const ImageLevel level(image, box);
  const Sampling sampling = sampling_of(box, 1);
  return placed(marched(place, level, sampling), image, level, sampling);
}

Surface make_isosurface(const std::string& place,
                        const ImageGeometry& image,
                        std::int64_t triangles) {
  const Region box = foreground_box(place, image);
  const ImageLevel level(image, box);
  Sampling best_sampling = sampling_of(box, 1);
  const auto wanted = static_cast<double>(triangles);
  const auto error_of = [&](double count) { return std::abs(count - wanted); };
  double step = 1;
  double count =
      static_cast<double>(count_marched(best_sampling.counts, plane_reader(level, best_sampling)));
  if (count <= wanted) {
    return placed(marched(place, level, best_sampling), image, level, best_sampling);
  }
  // The number of triangles falls as the square of the step.
  double best_error = error_of(count);
  for (int pass = 0; pass < 6 && best_error > 0.02 * wanted; ++pass) {
    step *= std::sqrt(std::max(count, 1.0) / wanted);
    const Sampling sampling = sampling_of(box, std::max(step, 1.0));
    count = static_cast<double>(count_marched(sampling.counts, plane_reader(level, sampling)));
    if (count > 0 && error_of(count) < best_error) {
      best_error = error_of(count);
      best_sampling = sampling;
    }
  }
  return placed(marched(place, level, best_sampling), image, level, best_sampling);
}

}  // namespace tetwarp
