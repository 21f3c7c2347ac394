/// @file image_materials.cpp
/// Sums density and moduli over the voxels that tetrahedra own.
#include "host/simulate/model/image_materials.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "host/base/index_space.hpp"
#include "host/base/point3.hpp"
#include "host/scene/volume_rows.hpp"
#include "host/scene/voxel_owner.hpp"
#include "host/simulate/model/body_part.hpp"
#include "host/simulate/model/tet_materials.hpp"

namespace tetwarp {
namespace {

constexpr double least_coverage = 0.02;

/// Sample of the voxel whose centre is nearest to a point.
double nearest_sample(const Grid& grid, VolumeRows& samples, const Point3& point) {
  const IndexFromWorld map = index_from_world(grid);
  std::array<std::int64_t, 3> ijk{};
  for (std::size_t d = 0; d < 3; ++d) {
    double index = 0;
    for (std::size_t e = 0; e < 3; ++e) index += map.linear[d][e] * (point[e] - map.origin[e]);
    const double last = static_cast<double>(grid.dims[d] - 1);
    ijk[d] = static_cast<std::int64_t>(std::clamp(std::nearbyint(index), 0.0, last));
  }
  return samples.row(ijk[1], ijk[2])[static_cast<std::size_t>(ijk[0])];
}

double voxel_volume_of(const Grid& grid) {
  const std::array<double, 9>& m = grid.direction;
  const double determinant = dot({m[0], m[1], m[2]}, cross({m[3], m[4], m[5]}, {m[6], m[7], m[8]}));
  return std::fabs(determinant) * grid.spacing[0] * grid.spacing[1] * grid.spacing[2];
}

/// Materials by value of the image; nothing: void.
class Transfer {
 public:
  explicit Transfer(const Body& body) : body_(body) {}

  std::optional<Material> at(double value) const {
    const auto& table = body_.transfer;
    if (table.empty()) return body_.material;
    const auto above =
        std::lower_bound(table.begin(), table.end(), value,
                         [](const TransferPoint& p, double v) { return p.value < v; });
    if (body_.lookup == TransferLookup::label) {
      if (above == table.end() || above->value != value) return std::nullopt;
      return above->material;
    }
    if (above == table.begin()) return table.front().material;
    if (above == table.end()) return table.back().material;
    const TransferPoint &a = *(above - 1), &b = *above;
    const double u = (value - a.value) / (b.value - a.value);
    const auto between = [u](double from, double to) { return from + u * (to - from); };
    return Material{between(a.material.youngs_modulus, b.material.youngs_modulus),
                    between(a.material.poissons_ratio, b.material.poissons_ratio),
                    between(a.material.density, b.material.density)};
  }

 private:
  const Body& body_;
};

/// Sums over the voxels of a tetrahedron that are not void.
struct VoxelSums {
  bool has_voxel = false;
  TetMass mass{};
  double count = 0;  ///< voxels that have a stiffness
  /// Sums of lambda and mu; for the harmonic mean of 1 / bulk modulus and 1 / mu.
  double first = 0, second = 0;

  void add_moduli(const Material& material, MaterialMean mean) {
    if (!(material.youngs_modulus > 0)) return;
    const double e = material.youngs_modulus, nu = material.poissons_ratio;
    const double mu = e / (2 * (1 + nu));
    count += 1;
    first +=
        mean == MaterialMean::harmonic ? 3 * (1 - 2 * nu) / e : e * nu / ((1 + nu) * (1 - 2 * nu));
    second += mean == MaterialMean::harmonic ? 1 / mu : mu;
  }
  void add_mass(double mass_of_voxel, const std::array<double, 4>& weight) {
    std::size_t k = 0;
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = a; b < 4; ++b) mass[k++] += mass_of_voxel * weight[a] * weight[b];
    }
  }
  /// lambda, mu: the mean over the voxels times the part of the volume that they cover.
  std::array<double, 2> moduli(MaterialMean mean, double coverage) const {
    if (count == 0) return {0, 0};
    const double covered = std::max(coverage, least_coverage);
    if (mean == MaterialMean::arithmetic) {
      return {covered * first / count, covered * second / count};
    }
    const double mu = count / second, bulk = count / first;
    return {covered * (bulk - 2 * mu / 3), covered * mu};
  }
};

std::array<double, 4> weights_at(const Point3& x,
                                 const Point3& first_node,
                                 const std::array<double, 9>& gradient) {
  const Point3 arm = minus(x, first_node);
  std::array<double, 4> weight{1, 0, 0, 0};
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t d = 0; d < 3; ++d) weight[a + 1] += gradient[3 * a + d] * arm[d];
    weight[0] -= weight[a + 1];
  }
  return weight;
}

}  // namespace

TetMaterials image_materials(const BodyPart& part, const ModelTets& tets, std::size_t first_tet) {
  const auto& image = std::get<ImageGeometry>(part.body.geometry);
  const Grid& grid = image.volume.grid;
  const double voxel_volume = voxel_volume_of(grid);
  VolumeRows samples(image.volume);
  const Transfer transfer(part.body);
  const auto node_of = [&](std::size_t t, std::size_t a) {
    return at(part.geometry.nodes, part.geometry.tets[t][a]);
  };
  std::vector<VoxelSums> sums(part.geometry.tets.size());
  const std::vector<std::int32_t> owner =
      voxel_owners(image.volume, {{0, 0, 0}, grid.dims}, {part.geometry.nodes, part.geometry.tets});
  std::size_t v = 0;
  for (std::int64_t k = 0; k < grid.dims[2]; ++k) {
    for (std::int64_t j = 0; j < grid.dims[1]; ++j) {
      const std::vector<double>& row = samples.row(j, k);
      for (std::int64_t i = 0; i < grid.dims[0]; ++i, ++v) {
        const double value = row[static_cast<std::size_t>(i)];
        if (owner[v] < 0 || !(value >= image.threshold)) continue;
        const auto t = static_cast<std::size_t>(owner[v]);
        sums[t].has_voxel = true;
        const std::optional<Material> material = transfer.at(value);
        if (!material) continue;
        const Point3 centre =
            grid.world_of({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        sums[t].add_moduli(*material, part.body.mean);
        sums[t].add_mass(material->density * voxel_volume,
                         weights_at(centre, node_of(t, 0), tets.gradient[first_tet + t]));
      }
    }
  }

  TetMaterials materials;
  for (std::size_t t = 0; t < sums.size(); ++t) {
    const double volume = tets.volume[first_tet + t];
    double coverage = sums[t].count * voxel_volume / volume;
    if (!sums[t].has_voxel) {
      // Tetrahedra smaller than a voxel may own none: the sample at the centroid stands for them.
      Point3 centroid{0, 0, 0};
      for (std::size_t a = 0; a < 4; ++a) centroid = plus(centroid, times(0.25, node_of(t, a)));
      if (const auto material = transfer.at(nearest_sample(grid, samples, centroid))) {
        sums[t].add_moduli(*material, part.body.mean);
        sums[t].mass = uniform_mass(material->density * volume);
      }
      coverage = 1;
    }
    const auto [lambda, mu] = sums[t].moduli(part.body.mean, coverage);
    materials.lambda.push_back(lambda);
    materials.mu.push_back(mu);
    materials.mass.push_back(sums[t].mass);
  }
  return materials;
}

}  // namespace tetwarp
