/// @file compose.cpp
/// Takes the voxel centers of a grid through a chain, some slices at a time.
#include "host/warp/compose/compose.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <stdexcept>
#include <tetwarp/error.hpp>
#include <tetwarp/map_points.hpp>
#include <utility>

#include "host/base/parallel.hpp"
#include "host/base/point3.hpp"
#include "host/warp/compose/field_inverse.hpp"

namespace tetwarp {
namespace {
/// Positions on their way through a chain.
class PointsOnTheirWay {
 public:
  PointsOnTheirWay(std::vector<Point3> points, std::span<std::uint8_t> reached, int threads)
      : points_(std::move(points)), reached_(reached), threads_(threads) {}

  const std::vector<Point3>& points() const { return points_; }

  /// @param check  called several times a second; may throw
  void apply(const ComposeLink& link, const std::function<void()>& check, ComposeNotes& notes) {
    if (const auto* const mesh = std::get_if<MovedMesh>(&link.transform)) {
      by_mesh(*mesh, link.is_inverse, notes);
      return;
    }
    const auto& transform = std::get<Transform>(link.transform);
    if (!link.is_inverse) {
      points_ = transformed(transform, std::move(points_));
    } else if (const auto* const affine = std::get_if<AffineTransform>(&transform)) {
      points_ = transformed(inverse_of(*affine), std::move(points_));
    } else {
      const FieldInverse inverse = invert_field(transform, points_, threads_, check);
      for (const std::size_t p : inverse.not_found) reached_[p] = 0;
      notes.not_inverted += std::ssize(inverse.not_found);
      notes.largest_residual = std::max(notes.largest_residual, inverse.largest_residual);
    }
  }

 private:
  void by_mesh(const MovedMesh& mesh, bool is_inverse, ComposeNotes& notes) {
    MappedPoints mapped = map_points(mesh.mesh, mesh.deformed, std::move(points_),
                                     {.inverse = !is_inverse, .threads = threads_});
    points_ = std::move(mapped.points);
    for (std::size_t p = 0; p < points_.size(); ++p) {
      if (mapped.owners[p] < 0) reached_[p] = 0;
    }
    notes.outside += mapped.outside;
    notes.straightened += mapped.straightened;
  }

  std::vector<Point3> points_;
  std::span<std::uint8_t> reached_;
  int threads_;
};

/// Centers of the voxels of some slices.
std::vector<Point3> centers_of(const Grid& grid, std::int64_t begin, std::int64_t end) {
  std::vector<Point3> centers;
  const std::int64_t slice = grid.dims[0] * grid.dims[1];
  centers.reserve(static_cast<std::size_t>((end - begin) * slice));
  for (std::int64_t k = begin; k < end; ++k) {
    for (std::int64_t v = 0; v < slice; ++v) {
      centers.push_back(
          grid.world_of({static_cast<double>(v % grid.dims[0]),
                         static_cast<double>(v / grid.dims[0]), static_cast<double>(k)}));
    }
  }
  return centers;
}
}  // namespace

ComposedField compose(std::span<const ComposeLink* const> links,
                      const Grid& grid,
                      int threads,
                      const Progress& progress) {
  check_grid(grid, "grid of the field");
  threads = thread_count(threads);
  ComposedField result{make_volume(grid, PixelType::float32, 3, "tetwarp_displacement"), {}, {}};
  result.reached.assign(static_cast<std::size_t>(grid.voxel_count()), 1);
  const std::span<float> numbers = result.field.samples<float>();
  const std::int64_t slice = grid.dims[0] * grid.dims[1];
  const std::int64_t part = std::max<std::int64_t>(1, (std::int64_t{1} << 22) / slice);
  const auto tell = [&](std::int64_t slices) {
    const double share = static_cast<double>(slices) / static_cast<double>(grid.dims[2]);
    if (progress && !progress(share)) throw Cancelled();
  };
  for (std::int64_t begin = 0; begin < grid.dims[2]; begin += part) {
    const std::int64_t end = std::min(begin + part, grid.dims[2]);
    const std::vector<Point3> centers = centers_of(grid, begin, end);
    const auto first = static_cast<std::size_t>(begin * slice);
    PointsOnTheirWay way(centers, std::span(result.reached).subspan(first, centers.size()),
                         threads);
    for (const ComposeLink* const link : links) {
      way.apply(
          *link, [&] { tell(begin); }, result.notes);
      tell(begin);
    }
    for (std::size_t v = 0; v < centers.size(); ++v) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        numbers[3 * (first + v) + axis] =
            static_cast<float>(way.points()[v][axis] - centers[v][axis]);
      }
    }
    tell(end);
  }
  return result;
}

AffineTransform inverse_of(const AffineTransform& affine) {
  const std::array<double, 9>& m = affine.matrix;
  AffineTransform inverse;
  double determinant = 0;
  for (std::size_t row = 0; row < 3; ++row) {
    const std::size_t r1 = (row + 1) % 3, r2 = (row + 2) % 3;
    for (std::size_t column = 0; column < 3; ++column) {
      const std::size_t c1 = (column + 1) % 3, c2 = (column + 2) % 3;
      inverse.matrix[3 * column + row] =
          m[3 * r1 + c1] * m[3 * r2 + c2] - m[3 * r1 + c2] * m[3 * r2 + c1];
      if (row == 0) determinant += m[column] * inverse.matrix[3 * column];
    }
  }
  if (!(std::abs(determinant) > 0)) {
    throw std::invalid_argument("its matrix is singular: it has no inverse");
  }
  for (double& entry : inverse.matrix) entry /= determinant;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t n = 0; n < 3; ++n) {
      inverse.offset[row] -= inverse.matrix[3 * row + n] * affine.offset[n];
    }
  }
  return inverse;
}

}  // namespace tetwarp
