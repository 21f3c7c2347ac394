/// @file cast.hpp
/// Pictures of volumes by rays: values become color and opacity, composited from front to back.
#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/export.hpp>
#include <tetwarp/make.hpp>
#include <tetwarp/volume.hpp>

namespace tetwarp {

/// A point of a transfer function.
struct ColorPoint {
  double value = 0;
  std::array<double, 3> color{};  ///< red, green, blue in sRGB, 0 to 1
  double opacity = 0;             ///< over `unit_length`, 0 to 1

  bool operator==(const ColorPoint&) const = default;
};

/// How values become color and opacity: linear between the points, constant beyond them. NaN is as
/// the first point.
struct TransferFunction {
  std::vector<ColorPoint> points;  ///< one or more, values ascending
  /// Where a ray goes d through opacity o, 1 - (1 - o)^(d / unit_length) of what lies behind is
  /// hidden [world].
  double unit_length = 1;
};

/// Points of the presets for samples from `low` to `high`.
/// @param preset  ct: soft tissue and bone; where samples reach from below -500 to above 300 they
///                are taken for Hounsfield units, else the range is divided. mr: gray
/// @throws std::invalid_argument  on another name
TETWARP_EXPORT std::vector<ColorPoint> preset_colors(const std::string& preset,
                                                     double low,
                                                     double high);

/// A two-hundredth of the diagonal of a grid, for which the opacities of presets are meant [world].
TETWARP_EXPORT double preset_length(const Grid& grid);

/// Least and largest finite sample, of several components of their Euclidean norm; 0 and 1 where
/// there is none.
TETWARP_EXPORT std::array<double, 2> finite_range(const Volume& volume);

/// A volume to draw. Samples fill the boxes of the voxels: linear between their centers, constant
/// from the outermost ones to the edge. Of several components their Euclidean norm is drawn.
struct CastVolume {
  const Volume* volume = nullptr;
  TransferFunction colors;
};

/// Draws volumes by rays, one through each pixel's center, among surfaces as render_surfaces()
/// draws them. Where volumes overlap, extinctions add and colors are mixed by them. A ray ends
/// where less than a thousandth of what lies behind would be seen.
///
/// The extinction is taken as constant over pieces of a ray of at most `step`, from their middles:
/// exact where the opacity is constant, whatever the step; else the error falls with its square.
/// @param step  over the smallest spacing of voxels, above 0
/// @throws std::invalid_argument  as render_surfaces(); on a volume whose samples do not fit its
///                                grid, or a bad transfer function or step
TETWARP_EXPORT Image cast_volumes(std::span<const CastVolume> volumes,
                                  std::span<const DrawnSurface> surfaces = {},
                                  std::span<const DrawnPlane> planes = {},
                                  const SurfaceRenderOptions& options = {},
                                  double step = 0.5);

/// The options with the gray window that render() takes for a volume, so that further pictures have
/// the same.
TETWARP_EXPORT RenderOptions with_window(const Volume& volume, const RenderOptions& options);

}  // namespace tetwarp
