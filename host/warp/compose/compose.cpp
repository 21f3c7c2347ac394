/// @file compose.cpp
/// Takes the voxel centers of a grid through a chain, some slices at a time.
#include "host/warp/compose/compose.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <stdexcept>
#include <tetwarp/error.hpp>
#include <tetwarp/map_points.hpp>
#include <utility>

#include "host/base/parallel.hpp"
#include "host/base/point3.hpp"
#include "host/warp/compose/field_inverse.hpp"

namespace tetwarp {
namespace {
/// A link, and of the inverse of a field or a spline what finds it.
struct AppliedLink {
  const ComposeLink& link;
  std::optional<FieldInverse> inverse;
};

std::vector<AppliedLink> applied_links(std::span<const ComposeLink* const> links) {
  std::vector<AppliedLink> applied;
  applied.reserve(links.size());
  for (const ComposeLink* const link : links) {
    AppliedLink& next = applied.emplace_back(AppliedLink{*link, {}});
    const auto* const transform = std::get_if<Transform>(&link->transform);
    if (transform == nullptr || !link->is_inverse) continue;
    if (!std::holds_alternative<DisplacementField>(*transform) &&
        !std::holds_alternative<BSplineTransform>(*transform)) {
      throw std::invalid_argument("links: only meshes, fields and splines are inverted here");
    }
    next.inverse.emplace(*transform);
  }
  return applied;
}

/// Positions that the links of a chain move, one after the other.
class MovedPositions {
 public:
  MovedPositions(std::vector<Point3> points, std::span<std::uint8_t> reached, int threads)
      : points_(std::move(points)), reached_(reached), threads_(threads) {}

  const std::vector<Point3>& points() const { return points_; }

  /// @param check  called several times a second; may throw
  void apply(AppliedLink& applied, const std::function<void()>& check, ComposeNotes& notes) {
    const auto& [transform, is_inverse] = applied.link;
    if (const auto* const mesh = std::get_if<MovedMesh>(&transform)) {
      by_mesh(*mesh, is_inverse, notes);
    } else if (applied.inverse) {
      const InverseResult result = applied.inverse->apply(points_, threads_, check);
      for (const std::size_t p : result.not_found) mark(p);
      notes.not_inverted += std::ssize(result.not_found);
      notes.largest_residual = std::max(notes.largest_residual, result.largest_residual);
    } else {
      move_by(std::get<Transform>(transform));
    }
  }

 private:
  void by_mesh(const MovedMesh& mesh, bool is_inverse, ComposeNotes& notes) {
    MappedPoints mapped = map_points(mesh.mesh, mesh.deformed, std::move(points_),
                                     {.inverse = !is_inverse, .threads = threads_});
    points_ = std::move(mapped.points);
    for (std::size_t p = 0; p < points_.size(); ++p) {
      if (mapped.owners[p] < 0) mark(p);
    }
    notes.outside += mapped.outside;
    notes.straightened += mapped.straightened;
  }

  void mark(std::size_t p) {
    if (!reached_.empty()) reached_[p] = 0;
  }

  void move_by(const Transform& transform) {
    constexpr std::int64_t most = 1 << 14;  // points of a task
    parallel_tasks(threads_, (std::ssize(points_) + most - 1) / most, [&](std::int64_t task) {
      const auto begin = points_.begin() + task * most;
      const auto end = begin + std::min(most, std::ssize(points_) - task * most);
      std::ranges::copy(transformed(transform, {begin, end}), begin);
    });
  }

  std::vector<Point3> points_;
  std::span<std::uint8_t> reached_;
  int threads_;
};

/// Slices that compose() moves at a time.
std::int64_t slices_of_a_part(const Grid& grid) {
  return std::max<std::int64_t>(1, (std::int64_t{1} << 22) / (grid.dims[0] * grid.dims[1]));
}

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

ComposeNotes compose_into(std::span<const ComposeLink* const> links,
                          const Grid& grid,
                          int threads,
                          const ComposeTarget& target,
                          const Progress& progress) {
  check_grid(grid, "grid of the field");
  const auto voxels = static_cast<std::size_t>(grid.voxel_count());
  if (links.empty() || target.displacements.size() != 3 * voxels ||
      (!target.reached.empty() && target.reached.size() != voxels)) {
    throw std::invalid_argument("links: none, or arrays of another size than the grid");
  }
  threads = thread_count(threads);
  std::ranges::fill(target.reached, std::uint8_t{1});
  ComposeNotes notes;
  const std::int64_t slice = grid.dims[0] * grid.dims[1], part = slices_of_a_part(grid);
  const auto tell = [&](std::int64_t slices) {
    const double share = static_cast<double>(slices) / static_cast<double>(grid.dims[2]);
    if (progress && !progress(share)) throw Cancelled();
  };
  std::vector<AppliedLink> applied = applied_links(links);
  for (std::int64_t begin = 0; begin < grid.dims[2]; begin += part) {
    const std::int64_t end = std::min(begin + part, grid.dims[2]);
    const std::vector<Point3> centers = centers_of(grid, begin, end);
    const auto first = static_cast<std::size_t>(begin * slice);
    const bool marks = !target.reached.empty();
    MovedPositions moved(
        centers, marks ? target.reached.subspan(first, centers.size()) : target.reached, threads);
    for (std::size_t n = 0; n < applied.size(); ++n) {
      const auto done = begin + (end - begin) * static_cast<std::int64_t>(n) / std::ssize(applied);
      tell(done);
      moved.apply(
          applied[n], [&] { tell(done); }, notes);
    }
    for (std::size_t v = 0; v < centers.size(); ++v) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        target.displacements[3 * (first + v) + axis] =
            static_cast<float>(moved.points()[v][axis] - centers[v][axis]);
      }
    }
    tell(end);
  }
  return notes;
}

ComposedField compose(std::span<const ComposeLink* const> links,
                      const Grid& grid,
                      int threads,
                      const Progress& progress) {
  check_grid(grid, "grid of the field");
  ComposedField result{make_volume(grid, PixelType::float32, 3, "tetwarp_displacement"), {}, {}};
  result.reached.resize(static_cast<std::size_t>(grid.voxel_count()));
  result.notes =
      compose_into(links, grid, threads, {result.field.samples<float>(), result.reached}, progress);
  return result;
}

double compose_memory(const Grid& grid, int threads) {
  constexpr double point_bytes = 60;  // places before and after, and which have no inverse yet
  constexpr double thread_bytes = 8 << 20;  // of the searches of FieldInverse
  const std::int64_t slices = std::min(grid.dims[2], slices_of_a_part(grid));
  return 3.0 * sizeof(float) * static_cast<double>(grid.voxel_count()) +
         point_bytes * static_cast<double>(grid.dims[0] * grid.dims[1] * slices) +
         thread_bytes * thread_count(threads);
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
