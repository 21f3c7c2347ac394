/// @file phantom_fish.cpp
/// A fish: a streamlined body with a spine and ribs, a tail and fins.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tetwarp/make.hpp>

#include "host/base/parallel.hpp"
#include "host/make/phantom_shapes.hpp"

namespace tetwarp {
namespace {
// Places are in shares of the grid: u and v from -1 to 1 along i and j, s from 0 at the head's end
// to 1 at the tail's end along k.
constexpr double margin = 0.02;
constexpr double fin_level = 90;
constexpr double flesh_level = 128;
constexpr double bone_level = 220;
constexpr double body_end = 0.84;  // s where the body has become the stalk of the tail
constexpr int rib_count = 14;
constexpr double fin_thickness = 0.035;

/// Half extents of the body at s: 0 at the snout, widest at a third, thin at the tail.
double body_profile(double s) {
  if (s <= 0 || s >= body_end + 0.08) return 0;
  const double t = s / (body_end + 0.08);
  return std::sqrt(t) * (1 - t) * (1 - 0.35 * t) * 2.9;
}

/// A cross-section at s.
struct Section {
  double s, half_width, half_height;

  explicit Section(double place)
      : s(place), half_width(0.50 * body_profile(place)), half_height(0.62 * body_profile(place)) {}

  /// Most that any part reaches from the plane u = 0.
  double reach() const { return std::max(half_width, fin_thickness); }
};

/// Depth inside a fin, a plate around u = 0 from v = low to v = high; above 0 inside.
double plate_depth(double u, double v, double low, double high) {
  return std::min({fin_thickness - std::abs(u), v - low, high - v});
}

double body_depth(const Section& section, double u, double v) {
  if (section.half_width < 0.01) return -1;
  return (1 - std::hypot(u / section.half_width, v / section.half_height)) * section.half_width;
}

/// Tail, a fork that opens from the stalk to the end; fins on the back, anal and at the belly.
double fin_depth(const Section& section, double u, double v) {
  double depth = -1;
  const double tail = (section.s - body_end) / (1 - margin - body_end);
  if (tail > 0 && tail < 1) {
    depth = plate_depth(u, std::abs(v), 0.5 * tail * tail - 0.08, 0.1 + 0.84 * tail);
  }
  const auto fin = [&](double side, double first, double last, double height) {
    const double t = (section.s - first) / (last - first);
    if (t <= 0 || t >= 1) return;
    const double top = section.half_height + height * std::sqrt(t) * (1 - t) * 2.6;
    depth = std::max(depth, plate_depth(u, side * v, section.half_height - 0.1, top));
  };
  fin(1, 0.30, 0.68, 0.38);
  fin(-1, 0.60, 0.76, 0.30);
  fin(-1, 0.34, 0.46, 0.22);
  return depth;
}

/// Spine, and ribs that curve around the belly.
double bone_depth(const Section& section, double u, double v) {
  double depth = -1;
  if (section.s > 0.14 && section.s < body_end) {
    depth = 0.045 - std::hypot(u, v - 0.1 * section.half_height);
  }
  if (section.s > 0.2 && section.s < 0.62 && v < 0) {
    const double along = std::remainder(section.s, 0.5 / rib_count) * 8;
    const double shell = std::hypot(u / section.half_width, v / section.half_height) - 0.72;
    depth = std::max(depth, 0.035 - std::hypot(shell * section.half_width, along));
  }
  return depth;
}

double fish_at(const Section& section, double u, double v, double voxel) {
  if (std::abs(u) > section.reach() + voxel) return 0;
  const double body = body_depth(section, u, v);
  double level = fin_level * coverage(-fin_depth(section, u, v), voxel);
  level += coverage(-body, voxel) * (flesh_level - level);
  const double bone = std::min(bone_depth(section, u, v), body);
  return level + coverage(-bone, voxel) * (bone_level - level);
}
}  // namespace

Volume make_fish_phantom(const std::array<std::int64_t, 3>& dims, const Point3& spacing) {
  Grid grid;
  grid.dims = dims;
  grid.spacing = spacing;
  Volume volume = make_volume(grid, PixelType::uint8, 1, "fish");
  std::uint8_t* const samples = volume.samples<std::uint8_t>().data();
  // From 0 to 1 between the margins.
  const auto place = [&](std::size_t axis, std::int64_t index) {
    const double share = (static_cast<double>(index) + 0.5) / static_cast<double>(dims[axis]);
    return (share - margin) / (1 - 2 * margin);
  };
  const double voxel = 2 / static_cast<double>(std::min(dims[0], dims[1]));
  parallel_tasks(thread_count(0), dims[2], [&](std::int64_t k) {
    std::uint8_t* sample = samples + k * dims[0] * dims[1];
    const Section section(place(2, k));
    for (std::int64_t j = 0; j < dims[1]; ++j) {
      for (std::int64_t i = 0; i < dims[0]; ++i) {
        const double level = fish_at(section, 2 * place(0, i) - 1, 2 * place(1, j) - 1, voxel);
        *sample++ = static_cast<std::uint8_t>(std::lround(level));
      }
    }
  });
  return volume;
}

}  // namespace tetwarp
