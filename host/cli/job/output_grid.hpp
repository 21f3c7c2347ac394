/// @file output_grid.hpp
/// The output grid, from the options --grid, --dims, --origin, --spacing and --direction.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/warp.hpp>

namespace tetwarp::cli {

/// The options as they were given.
struct GridChoice {
  std::string base = "same";  ///< "same", "bounds", or a volume file whose grid is taken
  std::string series;         ///< UID of the DICOM series if `base` is a folder
  std::optional<std::array<std::int64_t, 3>> dims;
  std::optional<Point3> origin;
  std::optional<Point3> spacing;
  std::optional<std::array<double, 9>> direction;

  /// Whether `base` is a file.
  bool has_file() const { return base != "same" && base != "bounds"; }
};

/// The base grid with those parts replaced that are given. Of dims and spacing, one that is given
/// alone determines the other: the box of the base grid's voxels is kept. Where voxels of that
/// spacing do not fill the box, they protrude equally on both sides. A given origin or direction
/// keeps the origin where it is when the size of the voxels changes.
/// Throws std::invalid_argument when the result is no valid grid.
/// @param world  itk_factor() of the source's positions, to which the grid of a volume file is
///               turned; nothing: that file's positions are taken for positions of the source
Grid resolve_grid(const GridChoice& choice,
                  const Grid& source,
                  const std::optional<Point3>& world,
                  const MeshReader& mesh,
                  const std::vector<std::int64_t>& steps);

/// The same for one set of positions of the nodes of a mesh.
/// @param positions  returns them; called if the choice depends on them
Grid resolve_grid(const GridChoice& choice,
                  const Grid& source,
                  const std::optional<Point3>& world,
                  const Mesh& mesh,
                  const std::function<std::vector<Point3>()>& positions);

/// itk_factor() of the volume file whose grid is chosen; nothing: none is, or it has none.
std::optional<Point3> base_factor(const GridChoice& choice);

/// Gives arrays without NiftiFacts codes and units of the volume file whose grid is chosen: for a
/// source whose positions have no unit.
void take_base_facts(const GridChoice& choice, std::vector<ArrayHeader>& arrays);

/// Reads "i0:i1,j0:j1,k0:k1". Throws std::invalid_argument.
Region parse_region(const std::string& text);

}  // namespace tetwarp::cli
