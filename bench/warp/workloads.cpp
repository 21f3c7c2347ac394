#include "bench/warp/workloads.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "host/base/counter_hash.hpp"
#include "host/base/pixel_dispatch.hpp"

namespace tetwarp::bench {
namespace {
constexpr double pi = std::numbers::pi;

Point3 bent(const Point3& p, const Point3& center, const Point3& uvw) {
  const double turn = 0.35 * (uvw[2] - 0.5);
  const double x = p[0] - center[0], y = p[1] - center[1];
  return {center[0] + std::cos(turn) * x - std::sin(turn) * y,
          center[1] + std::sin(turn) * x + std::cos(turn) * y + 12 * std::sin(pi * uvw[0]),
          p[2] + 8 * std::sin(2 * pi * uvw[0] + 1) * std::cos(pi * uvw[1])};
}

/// Six modes per axis: whole waves along each axis, 1.5 to 3 voxels high, of random phase.
Point3 moved_by_modes(const Point3& p, const Point3& uvw) {
  Point3 moved = p;
  for (std::size_t mode = 0; mode < 18; ++mode) {
    const std::uint64_t counter = 777 + 100 * mode;
    double phase = 2 * pi * unit_of(counter + 4);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double waves = std::floor(5 * unit_of(counter + axis)) - 2;
      phase += 2 * pi * waves * uvw[axis];
    }
    moved[mode / 6] += 1.5 * (1 + unit_of(counter + 5)) * std::sin(phase);
  }
  return moved;
}

Point3 swum(const Point3& p, const Point3& center, const Point3& uvw) {
  const double along = 2 * pi * uvw[2];
  const double turn = -0.35 * std::cos(along);
  const double x = p[0] - center[0];
  return {center[0] + 40 * std::sin(along) + std::cos(turn) * x, p[1], p[2] + std::sin(turn) * x};
}

std::vector<Point3> deform(const Workload& workload, const std::vector<Point3>& nodes) {
  Point3 center;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    center[axis] = static_cast<double>(workload.dims[axis] - 1) / 2;
  }
  if (workload.deformation == Deformation::ties || workload.deformation == Deformation::shift) {
    return scenes::shifted(nodes, {3, -2, 5});
  }
  if (workload.deformation == Deformation::rotation) return scenes::rotated_45_45(nodes, center);
  std::vector<Point3> deformed;
  for (const Point3& p : nodes) {
    Point3 uvw;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      uvw[axis] = (p[axis] + 0.5) / static_cast<double>(workload.dims[axis]);
    }
    deformed.push_back(workload.deformation == Deformation::bend    ? bent(p, center, uvw)
                       : workload.deformation == Deformation::modes ? moved_by_modes(p, uvw)
                                                                    : swum(p, center, uvw));
  }
  return deformed;
}

/// All voxel centers of the nodes' bounding box.
Grid bounding_grid(const std::vector<Point3>& nodes) {
  Grid grid;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto by_axis = [axis](const Point3& a, const Point3& b) { return a[axis] < b[axis]; };
    const auto [low, high] = std::minmax_element(nodes.begin(), nodes.end(), by_axis);
    grid.origin[axis] = std::ceil((*low)[axis]);
    grid.dims[axis] = static_cast<std::int64_t>(std::floor((*high)[axis]) - grid.origin[axis]) + 1;
  }
  return grid;
}

/// The image is a product and a sum of these waves, one value per plane of voxels.
std::vector<double> wave_along(std::int64_t dims, double waves, double phase) {
  std::vector<double> wave(static_cast<std::size_t>(dims));
  for (std::size_t i = 0; i < wave.size(); ++i) {
    const double u = (static_cast<double>(i) + 0.5) / static_cast<double>(dims);
    wave[i] = std::sin(2 * pi * (waves * u + phase));
  }
  return wave;
}

/// Squared distance from the middle of an axis, 1 where the ellipsoid Image::in_air ends.
std::vector<double> bulge_along(std::int64_t dims) {
  std::vector<double> bulge(static_cast<std::size_t>(dims));
  for (std::size_t i = 0; i < bulge.size(); ++i) {
    const double u = (static_cast<double>(i) + 0.5) / static_cast<double>(dims) - 0.5;
    bulge[i] = u * u / (0.46 * 0.46);
  }
  return bulge;
}
}  // namespace

Workload ties_128() {
  return {"W0_ties_128", {128, 128, 128}, {6, 6, 6}, Deformation::ties};
}
Workload torso_700() {
  return {"W1_torso_700", {256, 160, 122}, {7, 5, 4}, Deformation::bend};
}
Workload fish_35() {
  return {"W4_fish_35", {204, 202, 512}, {1, 1, 7}, Deformation::swim};
}

Workload shifted_256() {
  return {"W5_shifted_256", {256, 256, 256}, {6, 6, 6}, Deformation::shift};
}

Workload orange_160() {
  return {"W6_orange_160", {198, 199, 160}, {4, 4, 2}, Deformation::bend};
}

Workload rotated(std::int64_t n, int tets) {
  const int edge = static_cast<int>(std::lround(std::cbrt(tets / 5.0)));
  if (5 * edge * edge * edge != tets) {
    throw std::invalid_argument("rotated: " + std::to_string(tets) + " is not 5 k^3");
  }
  std::string name = "W2_rotated_" + std::to_string(n);
  if (tets != 1080) name += "_" + std::to_string(tets);
  return {name, {n, n, n}, {edge, edge, edge}, Deformation::rotation};
}

Workload waved(std::int64_t n, int tets) {
  static constexpr std::array<std::array<int, 3>, waved_tet_counts.size()> cells{
      {{2, 2, 2}, {4, 4, 4}, {6, 6, 6}, {10, 10, 10}, {20, 20, 25}, {40, 50, 50}}};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (waved_tet_counts[i] != tets) continue;
    const std::string name = "W3_waved_" + std::to_string(n) + "_" + std::to_string(tets);
    return {name, {n, n, n}, cells[i], Deformation::modes};
  }
  throw std::invalid_argument("waved: no split into " + std::to_string(tets) + " tetrahedra");
}

scenes::Scene make_scene(const Workload& workload) {
  scenes::Scene scene;
  scene.name = workload.name;
  scene.source_grid = scenes::unit_grid(workload.dims[0], workload.dims[1], workload.dims[2]);
  Point3 low{-0.5, -0.5, -0.5}, high;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    high[axis] = static_cast<double>(workload.dims[axis]) - 0.5;
  }
  if (workload.deformation == Deformation::ties) {  // planes every 20 voxels
    low = {0, 0, 0};
    high = {120, 120, 120};
  }
  scene.mesh = scenes::lattice(workload.cells, low, high);
  scene.deformed = deform(workload, scene.mesh.rest_positions);
  scene.output_grid = bounding_grid(scene.deformed);
  return scene;
}

double range_of(PixelType type) {
  return !is_integer(type) ? 1.0 : size_of(type) == 1 ? 254.0 : 4000.0;
}

Buffer make_image(const Grid& grid, PixelType type, Image image, int components) {
  if (type != PixelType::uint8 && type != PixelType::int16 &&
      !(size_of(type) >= 4 && !is_integer(type))) {
    throw std::invalid_argument(std::string("make_image: no image of ") + name_of(type));
  }
  const std::vector<double> along_x = wave_along(grid.dims[0], 3.3, 0.0);
  const std::vector<double> along_y = wave_along(grid.dims[1], 2.7, 0.25);
  const std::vector<double> along_z = wave_along(grid.dims[2], 4.1, 0.05);
  std::array<std::vector<double>, 3> bulge;
  for (std::size_t axis = 0; axis < 3; ++axis) bulge[axis] = bulge_along(grid.dims[axis]);
  const auto nx = static_cast<std::size_t>(grid.dims[0]);
  const auto ny = static_cast<std::size_t>(grid.dims[1]);
  const auto nz = static_cast<std::size_t>(grid.dims[2]);
  const auto count = static_cast<std::size_t>(components);
  Buffer buffer(nx * ny * nz * count * size_of(type));
  const double range = range_of(type);
  with_pixel_type(type, [&]<class T>(T) {
    T* const samples = reinterpret_cast<T*>(buffer.data());
#pragma omp parallel for schedule(static)
    for (std::size_t k = 0; k < nz; ++k) {
      for (std::size_t j = 0; j < ny; ++j) {
        for (std::size_t i = 0; i < nx; ++i) {
          const bool empty = image == Image::in_air && bulge[0][i] + bulge[1][j] + bulge[2][k] > 1;
          for (std::size_t c = 0; c < count; ++c) {
            const std::size_t at = ((k * ny + j) * nx + i) * count + c;
            const double noise = 0.1 * (unit_of(at) - 0.5);
            const double value = 0.5 + 0.2 * along_x[i] * along_y[j] + 0.2 * along_z[k] + noise;
            const double sample = empty ? 0.0 : range * value;
            samples[at] = static_cast<T>(is_integer(type) ? std::nearbyint(sample) : sample);
          }
        }
      }
    }
  });
  return buffer;
}

std::vector<Point3> nudged_center(const std::vector<Point3>& nodes, double share) {
  Point3 middle{0, 0, 0};
  for (const Point3& p : nodes) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      middle[axis] += p[axis] / static_cast<double>(nodes.size());
    }
  }
  const auto distance = [&](std::size_t node) {
    double square = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      square += (nodes[node][axis] - middle[axis]) * (nodes[node][axis] - middle[axis]);
    }
    return square;
  };
  std::vector<std::size_t> order(nodes.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
  order.resize(static_cast<std::size_t>(share * static_cast<double>(nodes.size())));
  std::vector<Point3> nudged = nodes;
  for (const std::size_t node : order) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      nudged[node][axis] += unit_of(3 * node + axis) - 0.5;
    }
  }
  return nudged;
}

}  // namespace tetwarp::bench
