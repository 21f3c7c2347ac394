/// @file transform_chain.cpp
/// Applies transforms to points, forward or back.
#include "host/cli/warp/transform_chain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "host/base/parallel.hpp"
#include "host/base/point3.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/common/interrupt.hpp"
#include "host/cli/warp/mapped_points.hpp"

namespace tetwarp::cli {
namespace {
constexpr std::string_view inverse_mark = "^-1";

/// The links of a chain, or the only transform.
std::vector<Transform> links_of_file(Transform transform) {
  std::vector<Transform> links;
  if (auto* const chain = std::get_if<TransformChain>(&transform)) {
    for (SingleTransform& link : chain->links) {
      std::visit([&](auto& single) { links.emplace_back(std::move(single)); }, link);
    }
  } else {
    links.push_back(std::move(transform));
  }
  return links;
}

/// Slices of a grid that displacements_of() moves at a time.
std::int64_t slices_of_a_part(const Grid& grid) {
  return std::max<std::int64_t>(1, (std::int64_t{1} << 22) / (grid.dims[0] * grid.dims[1]));
}

void move_by(const Transform& transform, int threads, std::vector<Point3>& points) {
  constexpr std::int64_t most = 1 << 14;  // points of a task
  parallel_tasks(thread_count(threads), (std::ssize(points) + most - 1) / most,
                 [&](std::int64_t task) {
                   const auto begin = points.begin() + task * most;
                   const auto end = begin + std::min(most, std::ssize(points) - task * most);
                   std::ranges::copy(transformed(transform, {begin, end}), begin);
                 });
}
}  // namespace

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

ChainLink::ChainLink(const std::string& word,
                     const MeshReadOptions& mesh,
                     const std::optional<Axes>& axes,
                     const std::optional<Point3>& world)
    : path_(word),
      is_inverse_(word.ends_with(inverse_mark)),
      options_{.axes = axes, .world = world, .step = 0, .takes_inverted = true} {
  if (is_inverse_) path_.resize(path_.size() - inverse_mark.size());
  if (kind_of(path_) != FileKind::mesh && is_transform_file(path_, options_)) {
    field_steps_ = transform_step_count(path_, options_);
    if (field_steps_ == 1) read_transforms();
    return;
  }
  check_mesh(path_, "expected a mesh, a displacement field or a transform of ITK");
  MeshReadOptions options = mesh;
  if (kind_of(path_) != FileKind::mesh) options.import.axes = axes.value_or(Axes::ras);
  mesh_.emplace(path_, options);
}

/// Those of the chosen step.
void ChainLink::read_transforms() {
  TransformFile file = read_transform(path_, options_);
  parts_.clear();
  for (Transform& single : links_of_file(std::move(file.transform))) {
    const std::size_t n = parts_.size();
    const bool is_inverted = n < file.is_inverted.size() && file.is_inverted[n];
    parts_.push_back(part_of(std::move(single), is_inverse_ != is_inverted));
  }
  if (is_inverse_) std::ranges::reverse(parts_);
}

ChainLink::Part ChainLink::part_of(Transform transform, bool is_inverse) const {
  if (!is_inverse) return transform;
  const auto* const affine = std::get_if<AffineTransform>(&transform);
  if (affine == nullptr) return FieldInverse(std::move(transform));
  try {
    return inverse_of(*affine);
  } catch (const std::invalid_argument& error) {
    throw IoError(path_, "", error.what());
  }
}

std::int64_t ChainLink::step_count() const {
  return mesh_ ? std::ssize(mesh_->header().times) : field_steps_;
}

void ChainLink::choose(std::int64_t step) {
  if (step_count() > 1) options_.step = step;
  if (mesh_) {
    deformed_ = mesh_->read_step(*options_.step);
  } else if (step_count() > 1) {
    read_transforms();
  }
}

bool ChainLink::iterates() const {
  return std::ranges::any_of(
      parts_, [](const Part& part) { return std::holds_alternative<FieldInverse>(part); });
}

void ChainLink::apply(int threads, std::vector<Point3>& points, ChainNotes& notes) {
  if (mesh_) {
    MappedPoints mapped =
        mapped_by(*mesh_, deformed_, std::move(points),
                  {.inverse = !is_inverse_, .threads = threads});  // as a warp samples its source
    notes.outside += mapped.outside;
    notes.straightened += mapped.straightened;
    points = std::move(mapped.points);
    return;
  }
  for (Part& part : parts_) {
    if (auto* const inverse = std::get_if<FieldInverse>(&part)) {
      const InverseCounts counts = inverse->apply(points, threads, stop_if_interrupted);
      notes.not_inverted += counts.not_found;
      notes.largest_residual = std::max(notes.largest_residual, counts.largest_residual);
    } else {
      move_by(std::get<Transform>(part), threads, points);
    }
  }
}

std::vector<std::string> ChainNotes::lines(std::int64_t count) const {
  std::vector<std::string> lines;
  if (outside > 0) {
    lines.push_back(fmt::format(
        "{} of {} positions were in no cell of a mesh and kept their place there", outside, count));
  }
  if (straightened > 0) {
    lines.push_back(
        fmt::format("{} times a position was mapped by the straight tetrahedron of its cell, whose "
                    "curved map has no inverse there",
                    straightened));
  }
  if (not_inverted > 0) {
    lines.push_back(
        fmt::format("{} of {} positions have no inverse: the field takes nothing there; they kept "
                    "their place",
                    not_inverted, count));
  }
  return lines;
}

double displacement_memory(const Grid& grid) {
  constexpr double point_bytes = 60;  // places before and after, and lists of FieldInverse
  const std::int64_t slices = std::min(grid.dims[2], slices_of_a_part(grid));
  return 3.0 * sizeof(float) * static_cast<double>(grid.voxel_count()) +
         point_bytes * static_cast<double>(grid.dims[0] * grid.dims[1] * slices);
}

std::vector<float> displacements_of(std::span<ChainLink> links,
                                    const Grid& grid,
                                    int threads,
                                    ChainNotes& notes) {
  std::vector<float> numbers;
  numbers.reserve(3 * static_cast<std::size_t>(grid.voxel_count()));
  const std::int64_t slice = grid.dims[0] * grid.dims[1], part = slices_of_a_part(grid);
  for (std::int64_t begin = 0; begin < grid.dims[2]; begin += part) {
    std::vector<Point3> voxels;
    for (std::int64_t k = begin; k < std::min(begin + part, grid.dims[2]); ++k) {
      for (std::int64_t v = 0; v < slice; ++v) {
        voxels.push_back(
            grid.world_of({static_cast<double>(v % grid.dims[0]),
                           static_cast<double>(v / grid.dims[0]), static_cast<double>(k)}));
      }
    }
    std::vector<Point3> points = voxels;
    for (auto link = links.rbegin(); link != links.rend(); ++link) {
      link->apply(threads, points, notes);
      stop_if_interrupted();
    }
    for (std::size_t v = 0; v < voxels.size(); ++v) {
      for (const double u : minus(points[v], voxels[v])) numbers.push_back(static_cast<float>(u));
    }
  }
  return numbers;
}

}  // namespace tetwarp::cli
