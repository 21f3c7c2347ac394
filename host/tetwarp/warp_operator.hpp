/// @file warp_operator.hpp
/// The warp as a linear map of samples, its transpose, and its derivatives: for reconstruction with
/// motion and for registration.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tetwarp/export.hpp>
#include <tetwarp/mesh.hpp>
#include <tetwarp/volume.hpp>
#include <tetwarp/warp.hpp>

namespace tetwarp {

/// Choices of a WarpOperator.
struct WarpOperatorOptions {
  Filter filter = Filter::linear;  ///< any but labels, which is not linear in the samples
  /// value; or conservative, which does not use `filter`, needs Outside::background, and stores W:
  /// 16 bytes for each pair of an output voxel and a voxel of the source that it takes of.
  Intensity intensity = Intensity::value;
  /// background: rows of voxels without a cell are zero; or identity.
  Outside outside = Outside::background;
  std::optional<Grid> output_grid = {};  ///< nothing: the grid of the source
  /// One per voxel of the output grid; rows of voxels with 0 are zero. Empty: none is left out.
  std::vector<std::uint8_t> mask = {};
  int threads = 0;  ///< up to 1024; 0: all cores
};

/// The matrix W of one deformation: W x are the samples that a warp of the samples x gives, with
/// background 0, in float64. Row v holds the weights of the filter at the position in the source of
/// output voxel v, which is that of Warper; the matrix is not stored. With Intensity::conservative
/// row v holds what the tetrahedra move into the box of v from the box of each voxel of the source,
/// over the volume of v: sums of W x over the output are those of x over the mesh at rest.
///
/// Samples are float64, [k][j][i][component] with any number of components, each of which is mapped
/// by the same W. Every sum is taken in one order, so that results have the same bits for every
/// number of threads. Calls of const functions may run at the same time.
class TETWARP_EXPORT WarpOperator {
 public:
  /// @param source    grid of the samples x
  /// @param mesh      rest state
  /// @param deformed  positions of its nodes [world]
  /// @throws std::invalid_argument  on any bad argument, naming it
  WarpOperator(const Grid& source,
               const Mesh& mesh,
               const std::vector<Point3>& deformed,
               const WarpOperatorOptions& options = {});
  WarpOperator(WarpOperator&&) noexcept;
  WarpOperator& operator=(WarpOperator&&) noexcept;
  ~WarpOperator();

  const Grid& source_grid() const;
  const Grid& output_grid() const;
  /// 1 per voxel of the output grid whose row is not zero, else 0.
  std::vector<std::uint8_t> support() const;

  /// y = W x.
  /// @param x  finite samples on the source grid
  /// @param y  out, on the output grid; must not overlap x
  /// @throws std::invalid_argument  sizes are not those of the grids times one number of components
  void forward(std::span<const double> x, std::span<double> y) const;

  /// x = W^T y, with the same weights as forward().
  /// @param y  finite, on the output grid
  /// @param x  out, on the source grid; must not overlap y
  /// @throws std::invalid_argument  as forward()
  void adjoint(std::span<const double> y, std::span<double> x) const;

  /// The derivative of <y, W x> by the deformed positions of the nodes, owners of voxels held
  /// fixed: what a node moves within cells, not what it uncovers at the surface of the mesh. Exact
  /// for the filter: where its slope jumps, as linear interpolation does at voxel centers, the mean
  /// of both sides.
  /// @param x  finite samples on the source grid
  /// @param y  finite, on the output grid
  /// @returns one vector per node [1 / world]
  /// @throws std::invalid_argument  as forward(), with Filter::nearest, which has no slope, or with
  ///                                Intensity::conservative
  std::vector<Point3> node_gradient(std::span<const double> x, std::span<const double> y) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tetwarp
