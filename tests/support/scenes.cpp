#include "tests/support/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "host/base/pixel_dispatch.hpp"

namespace tetwarp::scenes {

using namespace std::string_literals;

namespace {
constexpr double pi = 3.14159265358979323846;

/// Maps index-space points of a grid to world.
std::vector<Point3> to_world(const Grid& grid, std::vector<Point3> points) {
  for (Point3& p : points) p = grid.world_of(p);
  return points;
}

/// Scene whose mesh is given in index space of one grid, used for source and output.
Scene on_grid(std::string name, const Grid& grid, Mesh mesh, const std::vector<Point3>& deformed) {
  Scene scene{std::move(name), std::move(mesh), to_world(grid, deformed), grid, grid};
  scene.mesh.rest_positions = to_world(grid, scene.mesh.rest_positions);
  return scene;
}

/// Lattice whose inner layers along x are as thin as `thickness`.
Mesh sliver_lattice(double n, double thickness) {
  Mesh mesh = lattice({6, 3, 3}, {0, 0, 0}, {6, n, n});
  const double planes[7] = {
      1.3, n / 2, n / 2 + thickness, n / 2 + 2 * thickness, n / 2 + 3 * thickness, n - 4, n - 2};
  for (Point3& p : mesh.rest_positions) p[0] = planes[static_cast<int>(p[0])];
  return mesh;
}

/// Random nodes, random tetrahedra: overlapping, inverted, of every shape.
Mesh soup(double n, int tets, std::uint64_t seed) {
  Mesh mesh;
  for (int t = 0; t < tets; ++t) {
    std::array<std::int32_t, 4> tet;
    for (int a = 0; a < 4; ++a) {
      tet[static_cast<std::size_t>(a)] = static_cast<std::int32_t>(mesh.rest_positions.size());
      Point3 p;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        p[axis] = n * uniform(seed, static_cast<std::uint64_t>(12 * t + 3 * a) + axis);
      }
      mesh.rest_positions.push_back(p);
    }
    mesh.tets.push_back(tet);
  }
  return mesh;
}
}  // namespace

double uniform(std::uint64_t seed, std::uint64_t index) {
  std::uint64_t z = seed * 0x9e3779b97f4a7c15u + index * 0xd1342543de82ef95u + 0x632be59bd9b4e019u;
  for (int round = 0; round < 3; ++round) {
    z ^= z >> 32;
    z *= 0xd6e8feb86659fd93u;
  }
  z ^= z >> 32;
  return static_cast<double>(z >> 11) * 0x1p-53;
}

Mesh lattice(const std::array<int, 3>& cells, const Point3& low, const Point3& high) {
  static constexpr int even[5][4] = {
      {0, 1, 2, 4}, {3, 1, 7, 2}, {5, 1, 4, 7}, {6, 2, 7, 4}, {1, 2, 4, 7}};
  Mesh mesh;
  for (int k = 0; k <= cells[2]; ++k) {
    for (int j = 0; j <= cells[1]; ++j) {
      for (int i = 0; i <= cells[0]; ++i) {
        const int at[3] = {i, j, k};
        Point3 p;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          p[axis] = low[axis] + (high[axis] - low[axis]) * at[axis] / cells[axis];
        }
        mesh.rest_positions.push_back(p);
      }
    }
  }
  for (int k = 0; k < cells[2]; ++k) {
    for (int j = 0; j < cells[1]; ++j) {
      for (int i = 0; i < cells[0]; ++i) {
        // On odd cells the corners are mirrored along x, so that diagonals of shared faces meet.
        const int mirror = (i + j + k) & 1;
        for (const auto& corners : even) {
          std::array<std::int32_t, 4> tet;
          for (std::size_t a = 0; a < 4; ++a) {
            const int c = corners[a] ^ mirror;
            tet[a] =
                ((k + (c >> 2)) * (cells[1] + 1) + j + (c >> 1 & 1)) * (cells[0] + 1) + i + (c & 1);
          }
          if (mirror != 0) std::swap(tet[2], tet[3]);
          mesh.tets.push_back(tet);
        }
      }
    }
  }
  return mesh;
}

Grid unit_grid(std::int64_t nx, std::int64_t ny, std::int64_t nz) {
  Grid grid;
  grid.dims = {nx, ny, nz};
  return grid;
}

Grid oblique_grid(std::int64_t nx, std::int64_t ny, std::int64_t nz) {
  Grid grid = unit_grid(nx, ny, nz);
  const double a = 0.4, b = -0.7;
  grid.direction = {std::cos(a),
                    -std::sin(a) * std::cos(b),
                    std::sin(a) * std::sin(b),
                    std::sin(a),
                    std::cos(a) * std::cos(b),
                    -std::cos(a) * std::sin(b),
                    0,
                    std::sin(b),
                    std::cos(b)};
  grid.spacing = {0.7, 1.3, 2.1};
  grid.origin = {-120.5, 33.25, 410.125};
  return grid;
}

Volume wavy_volume(const Grid& grid, PixelType type, int components) {
  Volume volume = make_volume(grid, type, components);
  const double range = !is_integer(type) ? 1.0 : size_of(type) == 1 ? 120.0 : 4000.0;
  with_pixel_type(type, [&]<class T>(T) {
    const std::span<T> samples = volume.samples<T>();
    std::size_t at = 0;
    for (std::int64_t k = 0; k < grid.dims[2]; ++k) {
      for (std::int64_t j = 0; j < grid.dims[1]; ++j) {
        for (std::int64_t i = 0; i < grid.dims[0]; ++i) {
          for (int c = 0; c < components; ++c, ++at) {
            const double x = static_cast<double>(i), y = static_cast<double>(j),
                         z = static_cast<double>(k);
            const double wave = 0.5 + 0.2 * std::sin(0.11 * x + c) * std::cos(0.13 * y) +
                                0.2 * std::sin(0.17 * z + 0.3 * c) + 0.1 * (uniform(7, at) - 0.5);
            samples[at] = static_cast<T>(range * wave);
          }
        }
      }
    }
  });
  return volume;
}

Volume ramp_volume(const Grid& grid, const std::array<double, 4>& coefficients) {
  Volume volume = make_volume(grid, PixelType::float32);
  std::size_t at = 0;
  for (std::int64_t k = 0; k < grid.dims[2]; ++k) {
    for (std::int64_t j = 0; j < grid.dims[1]; ++j) {
      for (std::int64_t i = 0; i < grid.dims[0]; ++i, ++at) {
        volume.samples<float>()[at] = static_cast<float>(
            coefficients[0] + coefficients[1] * static_cast<double>(i) +
            coefficients[2] * static_cast<double>(j) + coefficients[3] * static_cast<double>(k));
      }
    }
  }
  return volume;
}

std::vector<Point3> rotated_45_45(const std::vector<Point3>& points, const Point3& center) {
  const double h = std::sqrt(0.5);
  std::vector<Point3> result;
  for (const Point3& p : points) {
    const double x = p[0] - center[0], y = p[1] - center[1], z = p[2] - center[2];
    const double turned = h * (x + y);
    result.push_back(
        {center[0] + h * (x - y), center[1] + h * (turned - z), center[2] + h * (turned + z)});
  }
  return result;
}

std::vector<Point3> waved(const std::vector<Point3>& points, double amplitude, std::uint64_t seed) {
  Point3 low = points.front(), high = low;
  for (const Point3& p : points) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  }
  std::vector<Point3> result = points;
  for (Point3& p : result) {
    Point3 u;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      u[axis] = (p[axis] - low[axis]) / std::max(high[axis] - low[axis], 1e-30);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::uint64_t mode = 0; mode < 3; ++mode) {
        const std::uint64_t at = 16 * (3 * axis + mode);
        double phase = 2 * pi * uniform(seed, at);
        for (std::size_t a = 0; a < 3; ++a) {
          phase += 2 * pi * std::floor(3 * uniform(seed, at + 1 + a)) * u[a];
        }
        p[axis] += amplitude / 3 * std::sin(phase);
      }
    }
  }
  return result;
}

std::vector<Point3> shifted(const std::vector<Point3>& points, const Point3& offset) {
  std::vector<Point3> result = points;
  for (Point3& p : result) {
    for (std::size_t axis = 0; axis < 3; ++axis) p[axis] += offset[axis];
  }
  return result;
}

std::vector<Scene> adversarial_scenes(std::int64_t n) {
  const double e = static_cast<double>(n);
  const Grid grid = unit_grid(n, n - 3, n + 2);
  const Mesh box = lattice({4, 4, 4}, {2, 2, 2}, {e - 6, e - 6, e - 6});
  const Mesh loose = lattice({4, 3, 5}, {-0.5, -0.5, -0.5}, {e - 0.5, e - 3.5, e + 1.5});
  const Mesh tiny =
      lattice({24, 24, 24}, {e / 3, e / 3, e / 3}, {e / 3 + 7.3, e / 3 + 7.1, e / 3 + 6.7});
  const Point3 center{e / 2, e / 2, e / 2};
  std::vector<Scene> scenes;
  const auto add = [&](const std::string& name, const Grid& on, const Mesh& mesh,
                       const std::vector<Point3>& deformed) {
    scenes.push_back(on_grid(name, on, mesh, deformed));
  };
  add("identity", grid, loose, loose.rest_positions);
  add("aligned", grid, box, shifted(box.rest_positions, {1, -2, 3}));
  add("half_voxel", grid, box, shifted(box.rest_positions, {0.5, -0.5, 1.5}));
  add("waved", grid, loose, waved(loose.rest_positions, 3.0, 11));
  add("rotated", grid, box, rotated_45_45(box.rest_positions, center));
  add("tiny", grid, tiny, waved(tiny.rest_positions, 0.3, 3));
  add("outside", grid, box, shifted(waved(box.rest_positions, 2.0, 5), {e * 0.6, -e * 0.4, 1.5}));
  add("oblique", oblique_grid(n, n - 3, n + 2), loose, waved(loose.rest_positions, 2.5, 17));

  for (const auto& [decades, thickness] : {std::pair{"1", 1e-1}, {"3", 1e-3}, {"5", 1e-5}}) {
    const Mesh thin = sliver_lattice(e, thickness);
    add("slivers_"s + decades, grid, thin, rotated_45_45(thin.rest_positions, center));
    add("thin_aligned_"s + decades, grid, thin, thin.rest_positions);
  }
  const Mesh random = soup(e, 60, 23);
  add("soup", grid, random, soup(e, 60, 29).rest_positions);

  Mesh large = soup(4 * e, 60, 37);  // each holds many cells, often the same ones
  large.rest_positions = shifted(large.rest_positions, {-1.5 * e, -1.5 * e, -1.5 * e});
  add("overlapping", grid, large, waved(large.rest_positions, 3.0, 43));

  Mesh folded = box;
  std::vector<Point3> over = folded.rest_positions;
  for (Point3& p : over) p[0] = e / 2 + std::abs(p[0] - e / 2);  // one half onto the other
  add("folded", grid, folded, over);

  std::vector<Point3> flat = box.rest_positions;
  for (Point3& p : flat) p[2] = std::max(p[2], e / 2);  // lower half squashed into a plane
  add("flat", grid, box, flat);

  Grid far = grid;
  far.origin = {1e6 * e, -1e6 * e, 3e6 * e};
  far.spacing = {0.7, 0.7, 0.7};
  add("far", far, box, rotated_45_45(box.rest_positions, center));

  // Another output grid: finer, shifted, mirrored.
  Scene other = on_grid("other_grid", grid, loose, waved(loose.rest_positions, 2.0, 31));
  other.output_grid.dims = {n + 7, n, n - 5};
  other.output_grid.spacing = {0.61, 0.83, 1.1};
  other.output_grid.origin = {e, 1.7, -2.4};
  other.output_grid.direction = {-1, 0, 0, 0, 1, 0, 0, 0, 1};
  scenes.push_back(std::move(other));
  return scenes;
}

Scene adversarial_scene(std::string_view name, std::int64_t n) {
  for (Scene& scene : adversarial_scenes(n)) {
    if (scene.name == name) return std::move(scene);
  }
  throw std::invalid_argument("no adversarial scene is named " + std::string(name));
}

}  // namespace tetwarp::scenes
