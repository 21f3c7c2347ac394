/// @file image_materials.cpp
/// Sums density and moduli over the voxels that tetrahedra own or share.
#include "host/simulate/model/image_materials.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "host/base/parallel.hpp"
#include "host/base/point3.hpp"
#include "host/scene/alike_bodies.hpp"
#include "host/scene/volume_rows.hpp"
#include "host/scene/voxel_owner.hpp"
#include "host/scene/voxel_shares.hpp"
#include "host/simulate/model/tet_materials.hpp"

namespace tetwarp {
namespace {

constexpr double least_coverage = 0.02;

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
  TetMass mass{};
  double covered = 0;  ///< shares in voxels of the foreground, void or not [voxel]
  double count = 0;    ///< shares in voxels that have a stiffness [voxel]
  /// Sums of lambda and mu; for the harmonic mean of 1 / bulk modulus and 1 / mu.
  double first = 0, second = 0;

  /// @param share  in the voxel, 0 to 1
  void add_moduli(const Material& material, MaterialMean mean, double share) {
    if (!(material.youngs_modulus > 0)) return;
    const double e = material.youngs_modulus, nu = material.poissons_ratio;
    const double mu = e / (2 * (1 + nu));
    count += share;
    first += share * (mean == MaterialMean::harmonic ? 3 * (1 - 2 * nu) / e
                                                     : e * nu / ((1 + nu) * (1 - 2 * nu)));
    second += share * (mean == MaterialMean::harmonic ? 1 / mu : mu);
  }
  void add_mass(double mass_of_voxel, const std::array<double, 4>& weight) {
    std::size_t k = 0;
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = a; b < 4; ++b) mass[k++] += mass_of_voxel * weight[a] * weight[b];
    }
  }
  void add_mass(double mass_of_voxel, const VoxelShare& share) {
    for (std::size_t k = 0; k < mass.size(); ++k) mass[k] += mass_of_voxel * share.product[k];
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

/// The sums of all tetrahedra of a body.
class ImageSums {
 public:
  explicit ImageSums(const BodyPart& part)
      : part_(part),
        image_(std::get<ImageGeometry>(part.body.geometry)),
        voxel_volume_(voxel_volume_of(image_.volume.grid)),
        transfer_(part.body),
        sums_(part.geometry.tets.size()) {}

  /// Each voxel of the foreground counts at its center, for its owner.
  void add_owned(const ModelTets& tets, std::size_t first_tet) {
    const Grid& grid = image_.volume.grid;
    const std::vector<std::int32_t> owner = voxel_owners(
        image_.volume, {{0, 0, 0}, grid.dims}, {part_.geometry.nodes, part_.geometry.tets});
    VolumeRows samples(image_.volume), levels(image_.volume, image_.threshold);
    std::size_t v = 0;
    for (std::int64_t k = 0; k < grid.dims[2]; ++k) {
      for (std::int64_t j = 0; j < grid.dims[1]; ++j) {
        const std::vector<double>& row = samples.row(j, k);
        const std::vector<double>& level = levels.row(j, k);
        for (std::int64_t i = 0; i < grid.dims[0]; ++i, ++v) {
          if (owner[v] < 0 || !(level[static_cast<std::size_t>(i)] >= 0)) continue;
          const auto t = static_cast<std::size_t>(owner[v]);
          sums_[t].covered += 1;
          const auto material = transfer_.at(row[static_cast<std::size_t>(i)]);
          if (!material) continue;
          const Point3 center = grid.world_of(
              {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
          sums_[t].add_moduli(*material, part_.body.mean, 1);
          sums_[t].add_mass(material->density * voxel_volume_,
                            weights_at(center, node_of(t, 0), tets.gradient[first_tet + t]));
        }
      }
    }
  }

  /// Each voxel of the foreground counts for all tetrahedra that share its box.
  void add_shares() {
    const std::vector<Point3> nodes = index_positions(image_.volume.grid, part_.geometry.nodes);
    const auto count = static_cast<std::int64_t>(sums_.size());
    parallel_for(threads_for(thread_count(0), count), count, [&](std::int64_t t) {
      const auto& [a, b, c, d] = part_.geometry.tets[static_cast<std::size_t>(t)];
      add_shares_of({at(nodes, a), at(nodes, b), at(nodes, c), at(nodes, d)},
                    sums_[static_cast<std::size_t>(t)]);
    });
  }

  TetMaterials materials(const ModelTets& tets, std::size_t first_tet) const {
    TetMaterials materials;
    for (std::size_t t = 0; t < sums_.size(); ++t) {
      const double coverage = sums_[t].count * voxel_volume_ / tets.volume[first_tet + t];
      const auto [lambda, mu] = sums_[t].moduli(part_.body.mean, coverage);
      materials.lambda.push_back(lambda);
      materials.mu.push_back(mu);
      materials.mass.push_back(sums_[t].mass);
    }
    return materials;
  }

  double covered_volume() const {
    double sum = 0;
    for (const VoxelSums& of : sums_) sum += of.covered;
    return sum * voxel_volume_;
  }
  /// Of all voxels of the foreground.
  double whole_volume() const {
    double count = 0;
    VolumeRows levels(image_.volume, image_.threshold);
    const auto& dims = image_.volume.grid.dims;
    for (std::int64_t k = 0; k < dims[2]; ++k) {
      for (std::int64_t j = 0; j < dims[1]; ++j) {
        for (const double level : levels.row(j, k)) count += level >= 0 ? 1 : 0;
      }
    }
    return count * voxel_volume_;
  }

 private:
  const Point3& node_of(std::size_t t, std::size_t a) const {
    return at(part_.geometry.nodes, part_.geometry.tets[t][a]);
  }

  /// @param corners  of the tetrahedron [voxel]
  void add_shares_of(const std::array<Point3, 4>& corners, VoxelSums& sums) const {
    double value = 0;
    const auto is_foreground = [&](const VoxelIndex& voxel) {
      value = sample_of(image_.volume, voxel);
      return sample_of(image_.volume, voxel, image_.threshold) >= 0;
    };
    for_shares(corners, {{0, 0, 0}, image_.volume.grid.dims}, is_foreground,
               [&](const VoxelIndex&, const VoxelShare& share) {
                 sums.covered += share.volume;
                 if (const auto material = transfer_.at(value)) {
                   sums.add_moduli(*material, part_.body.mean, share.volume);
                   sums.add_mass(material->density * voxel_volume_, share);
                 }
                 return true;
               });
  }

  const BodyPart& part_;
  const ImageGeometry& image_;
  double voxel_volume_;
  Transfer transfer_;
  std::vector<VoxelSums> sums_;
};

ImageMaterials materials_of(const BodyPart& part, const ModelTets& tets, std::size_t first_tet) {
  ImageSums sums(part);
  if (part.geometry.shares_voxels) {
    sums.add_shares();
  } else {
    sums.add_owned(tets, first_tet);
  }
  return {sums.materials(tets, first_tet), sums.whole_volume(), sums.covered_volume()};
}

bool have_same_materials(const Body& a, const Body& b) {
  return a.material == b.material && a.transfer == b.transfer && a.lookup == b.lookup &&
         a.mean == b.mean && are_alike(a, b);
}

}  // namespace

const ImageMaterials& ImageMaterialsOfBodies::of(const BodyPart& part,
                                                 const ModelTets& tets,
                                                 std::size_t first_tet) {
  for (const Made& made : made_) {
    if (have_same_materials(*made.body, part.body)) return made.materials;
  }
  return made_.emplace_back(Made{&part.body, materials_of(part, tets, first_tet)}).materials;
}

}  // namespace tetwarp
