/// @file output_grid.hpp
/// The grid that a warp writes: what the user said, resolved against source and mesh.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/warp.hpp>

namespace tetwarp::cli {

/// What the user said.
struct GridChoice {
  std::string base = "same";  ///< "same", "bounds", or a volume file whose grid is taken
  std::optional<std::array<std::int64_t, 3>> dims;
  std::optional<Point3> origin;
  std::optional<Point3> spacing;
  std::optional<std::array<double, 9>> direction;
};

/// The grid that is meant. What is given explicitly replaces that part of the base.
/// Throws std::invalid_argument when the result is no valid grid.
Grid resolve_grid(const GridChoice& choice,
                  const Grid& source,
                  const MeshReader& mesh,
                  const std::vector<std::int64_t>& steps);

/// "i0:i1,j0:j1,k0:k1". Throws std::invalid_argument.
Region parse_region(const std::string& text);

/// `grid` cut to the region, its origin moved; all of it without one. Throws std::invalid_argument
/// when the region leaves the grid.
Grid cut_grid(const Grid& grid, const std::optional<Region>& region);

}  // namespace tetwarp::cli
