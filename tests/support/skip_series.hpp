/// @file skip_series.hpp
/// Series of steps in which parts of a mesh move, and a Warper that writes each step over the one
/// before.
#pragma once
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/warp.hpp>

#include "tests/support/field_buffers.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {

/// Sources, a Warper and its outputs, which every step writes to.
class Series {
 public:
  std::vector<Volume> volumes;
  std::vector<std::uint8_t> mask;
  std::vector<std::int32_t> owner;
  FieldBuffers fields;

  Series(const std::vector<Volume>& sources, const scenes::Scene& scene, const WarpOptions& options)
      : warper_(views_of(sources), scene.mesh, with_grid(options, scene)) {
    const Grid& grid = warper_.output_grid();
    for (const Volume& source : sources) {
      volumes.push_back(make_volume(grid, source.type, source.components));
    }
    mask.assign(static_cast<std::size_t>(grid.voxel_count()), 0xee);
    owner.assign(mask.size(), -99);
    fields = FieldBuffers(grid, scene.source_grid == scene.output_grid);
  }

  Counts step(const std::vector<Point3>& deformed,
              bool holds_previous = true,
              const Progress& progress = {}) {
    std::vector<void*> pointers;
    for (Volume& volume : volumes) pointers.push_back(volume.data.data());
    const WarpTarget target = {.volumes = pointers,
                               .mask = mask.data(),
                               .owner = owner.data(),
                               .fields = fields.target(),
                               .holds_previous = holds_previous};
    return warper_.step(deformed, target, progress).counts;
  }

  /// Of the last step.
  const Totals& totals() const { return warper_.report().steps.back().totals; }

  /// The next step writes to other memory; the one after it to that of the last.
  void swap_targets() {
    if (other_volumes_.empty()) {
      other_volumes_ = volumes;
      other_mask_ = mask;
      other_owner_ = owner;
      other_fields_ = fields;
    }
    volumes.swap(other_volumes_);
    mask.swap(other_mask_);
    owner.swap(other_owner_);
    fields.swap(other_fields_);
  }

  bool has_bits_of(const Series& other) const {
    bool same = mask == other.mask && owner == other.owner && fields == other.fields;
    for (std::size_t s = 0; s < volumes.size(); ++s) {
      same = same && volumes[s].data == other.volumes[s].data;
    }
    return same;
  }

 private:
  static std::vector<VolumeView> views_of(const std::vector<Volume>& sources) {
    return {sources.begin(), sources.end()};
  }
  static WarpOptions with_grid(WarpOptions options, const scenes::Scene& scene) {
    options.output_grid = scene.output_grid;
    return options;
  }

  Warper warper_;
  std::vector<Volume> other_volumes_;
  std::vector<std::uint8_t> other_mask_;
  std::vector<std::int32_t> other_owner_;
  FieldBuffers other_fields_;
};

/// Applies `change` to the positions of the nodes within `radius` voxels of a point of the scene's
/// output grid.
template <class Change>
std::vector<Point3> changed_near(const scenes::Scene& scene,
                                 std::vector<Point3> positions,
                                 const Point3& center_index,
                                 double radius,
                                 Change&& change) {
  const Grid& grid = scene.output_grid;
  const Point3 center = grid.world_of(center_index);
  const double reach = radius * grid.spacing[0];
  for (std::size_t n = 0; n < positions.size(); ++n) {
    double square = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      square += std::pow(positions[n][axis] - center[axis], 2);
    }
    if (square <= reach * reach) change(n, positions[n]);
  }
  return positions;
}

/// Twelve steps: parts of the mesh shiver, move by whole voxels, leave the grid and return, are
/// inverted, flattened, or stay; in the last but one everything moves.
inline std::vector<std::vector<Point3>> partial_motions(const scenes::Scene& scene,
                                                        std::uint64_t seed) {
  const Grid& grid = scene.output_grid;
  std::vector<std::vector<Point3>> steps = {scene.deformed};
  const auto random = [&](std::uint64_t at) { return scenes::uniform(seed, at); };
  const auto somewhere = [&](std::uint64_t step) {
    Point3 index;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      index[axis] = random(100 * step + axis) * static_cast<double>(grid.dims[axis]);
    }
    return index;
  };
  const auto near = [&](double radius, auto&& change) {
    steps.push_back(changed_near(scene, steps.back(), somewhere(steps.size()), radius, change));
  };
  const auto shiver = [&](double voxels) {
    return [&, voxels](std::size_t n, Point3& p) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        p[axis] += voxels * grid.spacing[axis] * (random(1000 * steps.size() + 3 * n + axis) - 0.5);
      }
    };
  };
  const auto shift = [&](const Point3& voxels) {
    const Point3 to = grid.world_of(voxels);
    return [to, origin = grid.origin](std::size_t, Point3& p) {
      for (std::size_t axis = 0; axis < 3; ++axis) p[axis] += to[axis] - origin[axis];
    };
  };
  near(9, shiver(0.3));
  near(12, shift({2, 0, -1}));
  near(14, shift({300, 0, 0}));
  near(9, shiver(3));
  steps.push_back(steps.back());
  steps.push_back(steps[3]);  // nodes that had left return
  const Point3 mirror = grid.world_of(somewhere(50));
  near(13, [&](std::size_t, Point3& p) { p[1] = 2 * mirror[1] - p[1]; });
  near(12, [&](std::size_t, Point3& p) { p[2] = mirror[2]; });
  near(0, shiver(1));  // nothing, or a single node
  steps.push_back(scenes::waved(steps.back(), 2.0 * grid.spacing[0], seed));
  near(10, shiver(1));
  return steps;
}

}  // namespace tetwarp::test
