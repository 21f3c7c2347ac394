/// @file transform_chain.cpp
/// Reads the transforms of a file, forward or back.
#include "host/cli/warp/transform_chain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

#include "host/cli/common/file_checks.hpp"
#include "host/cli/common/interrupt.hpp"

namespace tetwarp::cli {
namespace {
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

ChainLink::ChainLink(const std::string& word,
                     const MeshReadOptions& mesh,
                     const std::optional<Axes>& axes,
                     const std::optional<Point3>& world)
    : path_(path_of(word)),
      is_inverse_(path_ != word),
      options_{.axes = axes, .world = world, .step = 0, .takes_inverted = true} {
  if (kind_of(path_) != FileKind::mesh && is_transform_file(path_, options_)) {
    field_steps_ = transform_step_count(path_, options_);
    if (field_steps_ == 1) read_transforms();
    return;
  }
  check_mesh(path_, "expected a mesh, a displacement field or a transform of ITK");
  MeshReadOptions options = mesh;
  if (kind_of(path_) != FileKind::mesh) options.import.axes = axes.value_or(Axes::ras);
  mesh_.emplace(path_, options);
  parts_.push_back({MovedMesh{{mesh_->mesh(), mesh_->mid_nodes()}, {}}, is_inverse_});
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
  for (ComposeLink& part : parts_) {
    auto* const affine = std::get_if<AffineTransform>(&std::get<Transform>(part.transform));
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
  const bool has_several = step_count() > 1;
  if (has_several) options_.step = step;
  if (mesh_) {
    std::get<MovedMesh>(parts_.front().transform).deformed = mesh_->read_step(*options_.step);
  } else if (has_several) {
    read_transforms();
  }
}

bool ChainLink::iterates() const {
  return !mesh_ && std::ranges::any_of(parts_, &ComposeLink::is_inverse);
}

ComposeNotes composed(std::span<const ChainLink> links,
                      const Grid& grid,
                      int threads,
                      std::span<float> displacements) {
  std::vector<const ComposeLink*> parts;
  for (auto link = links.rbegin(); link != links.rend(); ++link) {
    for (const ComposeLink& part : link->parts()) parts.push_back(&part);
  }
  return compose_into(parts, grid, threads, {displacements, {}}, [](double) {
    stop_if_interrupted();
    return true;
  });
}

std::vector<std::string> lines_of(const ComposeNotes& notes, std::int64_t count) {
  std::vector<std::string> lines;
  if (notes.outside > 0) {
    lines.push_back(
        fmt::format("{} times a position (of {}) was in no cell of a mesh and kept its place there",
                    notes.outside, count));
  }
  if (notes.straightened > 0) {
    lines.push_back(
        fmt::format("{} times a position was mapped by the straight tetrahedron of its cell, whose "
                    "curved map has no inverse there",
                    notes.straightened));
  }
  if (notes.not_inverted > 0) {
    lines.push_back(
        fmt::format("{} of {} positions have no inverse: the field takes nothing there; they kept "
                    "their place",
                    notes.not_inverted, count));
  }
  return lines;
}

}  // namespace tetwarp::cli
