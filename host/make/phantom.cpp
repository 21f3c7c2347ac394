/// @file phantom.cpp
/// Drawing of the anatomy on a grid: antialiased edges, skin and fat by depth, a faint texture.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tetwarp/make.hpp>
#include <variant>
#include <vector>

#include "host/base/counter_hash.hpp"
#include "host/base/parallel.hpp"
#include "host/make/phantom_shapes.hpp"
#include "host/make/phantom_torso.hpp"

namespace tetwarp {
namespace {
constexpr double skin_level = 0.42;
constexpr double fat_level = 0.24;
constexpr double muscle_level = 0.45;
constexpr double skin_depth = 3;       // [mm]
constexpr double fat_depth = 12;       // [mm]
constexpr double blend_length = 44;    // of the smooth transition between parts of the trunk [mm]
constexpr double half_height = 174;    // of the trunk, which ends at neck and hips [mm]
constexpr double texture_grain = 5;    // [mm]
constexpr double texture_depth = 0.1;  // share of the level

/// Distance to the smooth union of two solids (quadratic smooth minimum).
double blended(double a, double b) {
  const double overlap = std::max(blend_length - std::abs(a - b), 0.0) / blend_length;
  return std::min(a, b) - 0.25 * overlap * overlap * blend_length;
}

double trunk_distance(const Anatomy& anatomy, double x, double y, double z) {
  double distance = anatomy.trunk.front().distance(x, y, z);
  for (std::size_t part = 1; part < anatomy.trunk.size(); ++part) {
    distance = blended(distance, anatomy.trunk[part].distance(x, y, z));
  }
  return std::max(distance, std::abs(z) - half_height);
}

/// Gray level of skin, fat and muscle by the distance to the surface of the trunk.
double tissue_level(double distance, double voxel) {
  const double below_skin = coverage(distance + skin_depth, voxel);
  const double below_fat = coverage(distance + fat_depth, voxel);
  return skin_level + below_skin * (fat_level - skin_level) +
         below_fat * (muscle_level - fat_level);
}

/// Smooth noise in [0, 1): interpolated random numbers on a cubic lattice of spacing texture_grain.
double texture(double x, double y, double z) {
  const Point3 cell{x / texture_grain, y / texture_grain, z / texture_grain};
  std::uint64_t base[3];
  double weight[3];
  for (std::size_t d = 0; d < 3; ++d) {
    const double whole = std::floor(cell[d]);
    const double f = cell[d] - whole;
    base[d] = static_cast<std::uint64_t>(static_cast<std::int64_t>(whole) + 1024);
    weight[d] = f * f * (3 - 2 * f);
  }
  double sum = 0;
  for (std::uint64_t corner = 0; corner < 8; ++corner) {
    const std::uint64_t bits[3] = {corner & 1, corner >> 1 & 1, corner >> 2};
    double share = 1;
    std::uint64_t counter = 0;
    for (std::size_t d = 0; d < 3; ++d) {
      share *= bits[d] ? weight[d] : 1 - weight[d];
      counter = (counter << 20) + base[d] + bits[d];
    }
    sum += share * unit_of(counter);
  }
  return sum;
}

/// One slice of the phantom, drawn in float64.
class Slice {
 public:
  Slice(const Grid& grid, std::int64_t k)
      : grid_(grid),
        z_(grid.origin[2] + grid.spacing[2] * static_cast<double>(k)),
        voxel_((grid.spacing[0] + grid.spacing[1] + grid.spacing[2]) / 3),
        body_(static_cast<std::size_t>(grid.dims[0] * grid.dims[1])),
        level_(body_.size()) {}

  void paint_trunk(const Anatomy& anatomy) {
    for (std::int64_t j = 0; j < grid_.dims[1]; ++j) {
      for (std::int64_t i = 0; i < grid_.dims[0]; ++i) {
        const double distance = trunk_distance(anatomy, at(0, i), at(1, j), z_);
        body_[pixel(i, j)] = coverage(distance, voxel_);
        level_[pixel(i, j)] = tissue_level(distance, voxel_);
      }
    }
  }

  void paint(const Organ& organ) {
    std::visit([&](const auto& solid) { paint(solid, organ.level); }, organ.solid);
  }

  void store(float* samples) const {
    for (std::int64_t j = 0; j < grid_.dims[1]; ++j) {
      for (std::int64_t i = 0; i < grid_.dims[0]; ++i) {
        const std::size_t p = pixel(i, j);
        if (body_[p] == 0) continue;
        const double grain = texture_depth * (texture(at(0, i), at(1, j), z_) - 0.5);
        samples[p] = static_cast<float>(body_[p] * level_[p] * (1 + grain));
      }
    }
  }

 private:
  double at(std::size_t axis, std::int64_t index) const {
    return grid_.origin[axis] + grid_.spacing[axis] * static_cast<double>(index);
  }
  std::size_t pixel(std::int64_t i, std::int64_t j) const {
    return static_cast<std::size_t>(j * grid_.dims[0] + i);
  }

  /// First index at or after a position.
  std::int64_t index_from(std::size_t axis, double position) const {
    const double index = std::ceil((position - grid_.origin[axis]) / grid_.spacing[axis]);
    return static_cast<std::int64_t>(std::clamp(index, 0.0, static_cast<double>(grid_.dims[axis])));
  }

  template <class Solid>
  void paint(const Solid& solid, double level) {
    const Extent box = solid.extent();
    if (z_ < box.low[2] - voxel_ || z_ > box.high[2] + voxel_) return;
    const std::int64_t i_end = index_from(0, box.high[0] + voxel_);
    const std::int64_t j_end = index_from(1, box.high[1] + voxel_);
    for (std::int64_t j = index_from(1, box.low[1] - voxel_); j < j_end; ++j) {
      for (std::int64_t i = index_from(0, box.low[0] - voxel_); i < i_end; ++i) {
        double& painted = level_[pixel(i, j)];
        painted += coverage(solid.distance(at(0, i), at(1, j), z_), voxel_) * (level - painted);
      }
    }
  }

  const Grid& grid_;
  double z_;
  double voxel_;               // mean spacing, the width of antialiased edges [mm]
  std::vector<double> body_;   // share of the voxel inside the body
  std::vector<double> level_;  // gray level there
};

Grid grid_of(const std::array<std::int64_t, 3>& dims) {
  Grid grid;
  grid.dims = dims;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid.spacing[axis] = anatomy_size[axis] / static_cast<double>(dims[axis]);
    grid.origin[axis] = 0.5 * (grid.spacing[axis] - anatomy_size[axis]);
  }
  return grid;
}
}  // namespace

Volume make_phantom(const std::array<std::int64_t, 3>& dims) {
  Volume volume = make_volume(grid_of(dims), PixelType::float32, 1, "phantom");
  const Anatomy anatomy = make_torso();
  float* samples = volume.samples<float>().data();
  parallel_tasks(thread_count(0), dims[2], [&](std::int64_t k) {
    Slice slice(volume.grid, k);
    slice.paint_trunk(anatomy);
    for (const Organ& organ : anatomy.organs) slice.paint(organ);
    slice.store(samples + k * dims[0] * dims[1]);
  });
  return volume;
}

}  // namespace tetwarp
