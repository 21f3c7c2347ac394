/// @file fem_body.cpp
/// Fills elements uniformly, or by the voxels that they own or share.
#include "host/reference/simulate/fem_body.hpp"

#include <algorithm>
#include <cmath>

#include "host/reference/simulate/image_material.hpp"

namespace tetwarp::reference {
namespace {

using ElementMass = Eigen::Matrix4d;
constexpr double least_coverage = 0.02;

/// rho V (1 + delta_ab)/20, the integral of rho N_a N_b.
ElementMass uniform_mass(double mass) {
  return mass / 20 * (ElementMass::Ones() + ElementMass::Identity());
}

ElementMass fill_uniformly(const Material& material, double fraction, Element& element) {
  const auto [lambda, mu] = lame_of(material.youngs_modulus, material.poissons_ratio);
  element.lambda = lambda * std::max(fraction, least_coverage);
  element.mu = mu * std::max(fraction, least_coverage);
  return uniform_mass(material.density * element.volume * fraction);
}

/// Means of the moduli over voxels: arithmetic of lambda and mu, or harmonic of the bulk and the
/// shear modulus.
class ModulusMean {
 public:
  explicit ModulusMean(MaterialMean kind) : kind_(kind) {}

  void add(const Material& material, double share) {
    const auto [lambda, mu] = lame_of(material.youngs_modulus, material.poissons_ratio);
    const double bulk = lambda + 2 * mu / 3;
    count_ += share;
    first_ += share * (kind_ == MaterialMean::harmonic ? 1 / bulk : lambda);
    second_ += share * (kind_ == MaterialMean::harmonic ? 1 / mu : mu);
  }
  double count() const { return count_; }
  /// lambda, mu; at least one material was added.
  std::array<double, 2> value() const {
    if (kind_ == MaterialMean::arithmetic) return {first_ / count_, second_ / count_};
    const double mu = count_ / second_;
    return {count_ / first_ - 2 * mu / 3, mu};
  }

 private:
  MaterialMean kind_;
  double count_ = 0, first_ = 0, second_ = 0;
};

ElementMass fill_by_voxels(const Body& body,
                           const std::vector<HeldVoxel>& voxels,
                           double voxel_volume,
                           Element& element) {
  ElementMass mass = ElementMass::Zero();
  ModulusMean moduli(body.mean);
  for (const HeldVoxel& voxel : voxels) {
    const auto material = material_at(body, voxel.value);
    if (!material) continue;
    mass += material->density * voxel_volume * voxel.products;
    if (material->youngs_modulus > 0) moduli.add(*material, voxel.share);
  }
  if (moduli.count() > 0) {
    const double coverage = moduli.count() * voxel_volume / element.volume;
    const auto [lambda, mu] = moduli.value();
    element.lambda = lambda * std::max(coverage, least_coverage);
    element.mu = mu * std::max(coverage, least_coverage);
  }
  return mass;
}

}  // namespace

FemBody fem_body(const Body& body, const BodyGeometry& geometry) {
  const auto node_count = static_cast<Eigen::Index>(geometry.nodes.size());
  const auto* image = std::get_if<ImageGeometry>(&body.geometry);
  std::vector<std::vector<HeldVoxel>> voxels;
  double voxel_volume = 0;
  if (image != nullptr) {
    voxels = geometry.shares_voxels ? shared_voxels(*image, geometry.nodes, geometry.tets)
                                    : owned_voxels(*image, geometry.nodes, geometry.tets);
    const Grid& grid = image->volume.grid;
    const Eigen::Map<const Matrix3d> direction(grid.direction.data());
    voxel_volume =
        std::abs(direction.determinant()) * grid.spacing[0] * grid.spacing[1] * grid.spacing[2];
  }
  FemBody result{{}, MatrixXd::Zero(node_count, node_count)};
  for (std::size_t t = 0; t < geometry.tets.size(); ++t) {
    const auto& nodes = geometry.tets[t];
    Matrix34 rest;
    for (int a = 0; a < 4; ++a) {
      const auto node = static_cast<std::size_t>(nodes[static_cast<std::size_t>(a)]);
      rest.col(a) = vector_of(geometry.nodes[node]);
    }
    Element element = element_of(nodes, rest);
    ElementMass mass;
    if (image == nullptr) {
      const double fraction = geometry.tet_fraction.empty() ? 1 : geometry.tet_fraction[t];
      mass = fill_uniformly(body.material, fraction, element);
    } else {
      mass = fill_by_voxels(body, voxels[t], voxel_volume, element);
    }
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        result.mass(nodes[static_cast<std::size_t>(a)], nodes[static_cast<std::size_t>(b)]) +=
            mass(a, b);
      }
    }
    result.elements.push_back(element);
  }
  if (body.mass == MassKind::lumped) {
    const VectorXd sums = result.mass.rowwise().sum();
    result.mass = sums.asDiagonal();
  }
  return result;
}

}  // namespace tetwarp::reference
