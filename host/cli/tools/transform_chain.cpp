/// @file transform_chain.cpp
/// Applies one transform to points, forward or back.
#include "host/cli/tools/transform_chain.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "host/cli/common/file_checks.hpp"
#include "host/cli/common/interrupt.hpp"
#include "host/cli/tools/field_inverse.hpp"
#include "host/cli/tools/mapped_points.hpp"

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
    parts_.push_back({std::move(single), is_inverse_ != is_inverted});
  }
  if (is_inverse_) std::ranges::reverse(parts_);
  for (Part& part : parts_) {
    auto* const affine = std::get_if<AffineTransform>(&part.transform);
    if (affine == nullptr || !part.is_inverse) continue;
    try {
      *affine = inverse_of(*affine);
      part.is_inverse = false;
    } catch (const std::invalid_argument& error) {
      throw IoError(path_, "", error.what());
    }
  }
}

std::int64_t ChainLink::step_count() const {
  return mesh_ ? std::ssize(mesh_->header().times) : field_steps_;
}

void ChainLink::choose(std::int64_t step) {
  if (step_count() == 1) return;
  options_.step = step;
  if (!mesh_) read_transforms();
}

bool ChainLink::iterates() const {
  return std::ranges::any_of(parts_, &Part::is_inverse);
}

void ChainLink::apply(int threads, std::vector<Point3>& points, ChainNotes& notes) const {
  if (mesh_) {
    MappedPoints mapped =
        mapped_by(*mesh_, *options_.step, std::move(points),
                  {.inverse = !is_inverse_, .threads = threads});  // as a warp samples its source
    notes.outside += mapped.outside;
    notes.straightened += mapped.straightened;
    points = std::move(mapped.points);
    return;
  }
  for (const Part& part : parts_) {
    if (part.is_inverse) {
      const InverseCounts counts = invert_field(part.transform, points, stop_if_interrupted);
      notes.not_inverted += counts.not_found;
      notes.largest_residual = std::max(notes.largest_residual, counts.largest_residual);
    } else {
      points = transformed(part.transform, std::move(points));
    }
  }
}

}  // namespace tetwarp::cli
