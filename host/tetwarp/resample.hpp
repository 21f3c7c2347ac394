/// @file resample.hpp
/// Volumes resampled by affine transforms, displacement fields and splines.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include <tetwarp/export.hpp>
#include <tetwarp/volume.hpp>
#include <tetwarp/warp.hpp>

namespace tetwarp {

/// x -> matrix x + offset [world].
struct AffineTransform {
  std::array<double, 9> matrix{1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row major
  Point3 offset{0, 0, 0};
};

/// x -> x + displacement(x) [world], between voxel centers linear, constant for the last half
/// voxel, zero beyond: the rule of ITK's DisplacementFieldTransform.
struct DisplacementField {
  Grid grid;
  std::vector<float> displacement;  ///< [k][j][i][3], along the world's axes
};

/// x -> x + s(x) [world], s the cubic B-spline with these coefficients at the knots of a grid; zero
/// where not all 4 x 4 x 4 coefficients around x are there: the rule of ITK's BSplineTransform.
struct BSplineTransform {
  Grid grid;                         ///< of the coefficients, at least 4 along each axis
  std::vector<double> coefficients;  ///< [k][j][i][3], along the world's axes
};

using SingleTransform = std::variant<AffineTransform, DisplacementField, BSplineTransform>;

/// Transforms one after the other: the first one is applied to x first.
struct TransformChain {
  std::vector<SingleTransform> links;
};

/// Takes the position of an output voxel to the position of its sample in the source.
using Transform =
    std::variant<AffineTransform, DisplacementField, BSplineTransform, TransformChain>;

/// Where a transform takes points.
/// @throws std::invalid_argument  as resample(), about the transform
TETWARP_EXPORT std::vector<Point3> transformed(const Transform& transform,
                                               std::vector<Point3> points);

/// Choices of resample(). It runs on the processor.
struct ResampleOptions {
  Filter filter = Filter::linear;            ///< 64-bit integers: nearest and labels only
  LabelRule label_rule = LabelRule::linear;  ///< with Filter::labels; not LabelRule::volume
  LabelGaussian label_gaussian = {};
  Overshoot overshoot = Overshoot::keep;
  double background = 0;       ///< beyond the source; rounded to the pixel type, saturated
  bool only_in_field = false;  ///< background beyond displacement fields and splines, too
  std::optional<Grid> output_grid = {};  ///< nothing: the grid of the sources
  int threads = 0;                       ///< 0: all cores
};

/// Resamples volumes: an output voxel at x gets the sample of the source at transform(x). Samples
/// are those of a warp: the source reaches half a voxel beyond its outermost centers.
/// @param sources   at least one, all on one grid, in host memory
/// @param outputs   one array per source, [k][j][i][component] over the output grid, in the pixel
///                  type of the source
/// @param progress  may be empty
/// @throws std::invalid_argument  on any bad argument, naming it
/// @throws Cancelled              when `progress` returned false
TETWARP_EXPORT void resample(std::span<const VolumeView> sources,
                             const Transform& transform,
                             const ResampleOptions& options,
                             std::span<void* const> outputs,
                             const Progress& progress = {});

/// The same for one volume.
TETWARP_EXPORT Volume resample(const Volume& source,
                               const Transform& transform,
                               const ResampleOptions& options = {});

}  // namespace tetwarp
