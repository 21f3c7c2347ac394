/// @file output_grid.cpp
/// The output grid from a choice: the grid of a volume, or a box around the deformed mesh.
#include "host/cli/job/output_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tetwarp/itk_space.hpp>

#include "host/base/index_space.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/common/interrupt.hpp"
#include "host/cli/job/output_files.hpp"
#include "host/cli/job/step_selection.hpp"

namespace tetwarp::cli {
namespace {
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Index-space position of a world position.
Point3 index_of(const IndexFromWorld& map, const Point3& world) {
  Point3 index{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      index[row] += map.linear[row][axis] * (world[axis] - map.origin[axis]);
    }
  }
  return index;
}

/// A box in index space around cells.
struct IndexBox {
  Point3 low{infinity, infinity, infinity};
  Point3 high{-infinity, -infinity, -infinity};

  /// Extends the box by all deformed cells of a mesh.
  void include(const IndexFromWorld& map, const Mesh& mesh, const std::vector<Point3>& positions) {
    const auto include_cell = [&](const auto& cell) {
      for (const std::int32_t node : cell) {
        const Point3 index = index_of(map, positions[static_cast<std::size_t>(node)]);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          low[axis] = std::min(low[axis], index[axis]);
          high[axis] = std::max(high[axis], index[axis]);
        }
      }
    };
    std::ranges::for_each(mesh.tets, include_cell);
    std::ranges::for_each(mesh.hexes, include_cell);
  }
};

/// The smallest box of voxels of the source's lattice, continued beyond the source, that encloses
/// an index box; at least two voxels along each axis.
Grid grid_of(const Grid& source, const IndexBox& box) {
  Grid grid = source;
  Point3 first{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first[axis] = std::floor(box.low[axis]);
    const double count = std::max(std::ceil(box.high[axis]) - first[axis] + 1, 2.0);
    // Far beyond what check_grid() accepts; keeps the conversion defined.
    grid.dims[axis] = static_cast<std::int64_t>(std::min(count, 0x1p40));
  }
  grid.origin = source.world_of(first);
  return grid;
}

/// The grid with `dims` or `spacing` of the choice, the other one and the origin such that the box
/// of its voxels stays. What check_grid() refuses is left for it.
Grid with_box_kept(const GridChoice& choice, const Grid& base) {
  Grid grid = base;
  Point3 first{};  // center of the first voxel, in voxels of the base
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double length = static_cast<double>(base.dims[axis]) * base.spacing[axis];
    if (choice.spacing) {
      grid.spacing[axis] = (*choice.spacing)[axis];
      if (!(grid.spacing[axis] > 0)) continue;
      // The tolerance is for quotients that are whole but for rounding.
      const double count = std::max(std::ceil(length / grid.spacing[axis] - 1e-6), 1.0);
      grid.dims[axis] = static_cast<std::int64_t>(std::min(count, 0x1p40));
    } else {
      grid.dims[axis] = (*choice.dims)[axis];
      if (grid.dims[axis] < 1) continue;
      grid.spacing[axis] = length / static_cast<double>(grid.dims[axis]);
    }
    const double between_centers =
        static_cast<double>(grid.dims[axis] - 1) * grid.spacing[axis] / base.spacing[axis];
    first[axis] = 0.5 * (static_cast<double>(base.dims[axis] - 1) - between_centers);
  }
  if (!choice.direction) grid.origin = base.world_of(first);
  return grid;
}

/// The header of the volume file whose grid is chosen.
VolumeHeader base_header(const GridChoice& choice) {
  VolumeReadOptions read;
  read.series = choice.series;
  return read_volume_header(choice.base, read);
}

/// Its grid in the world of the source.
Grid base_grid(const GridChoice& choice, const std::optional<Point3>& world) {
  const VolumeHeader base = base_header(choice);
  const std::optional<Point3> factor = itk_factor(choice.base, base);
  return world && factor ? scaled(base.grid, ratio(*factor, *world)) : base.grid;
}

/// @param bounds  the grid of `--grid bounds`
template <class Bounds>
Grid resolve(const GridChoice& choice,
             const Grid& source,
             const std::optional<Point3>& world,
             const Bounds& bounds) {
  Grid grid = source;
  if (!choice.series.empty() && (choice.base == "same" || choice.base == "bounds")) {
    throw std::invalid_argument(
        "--like-series is of the folder of DICOM images that --like names; add --like FOLDER, or "
        "leave it out");
  }
  check_series(choice.series, {choice.base}, "--like-series");
  if (choice.base == "bounds") {
    grid = bounds();
  } else if (choice.has_file()) {
    grid = base_grid(choice, world);
  }
  if (choice.dims.has_value() != choice.spacing.has_value()) grid = with_box_kept(choice, grid);
  grid.dims = choice.dims.value_or(grid.dims);
  grid.origin = choice.origin.value_or(grid.origin);
  grid.spacing = choice.spacing.value_or(grid.spacing);
  grid.direction = choice.direction.value_or(grid.direction);
  try {
    check_grid(grid, "output grid");
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string(error.what()) +
                                "; correct --grid, --dims, --origin, --spacing or --direction");
  }
  return grid;
}
}  // namespace

Grid resolve_grid(const GridChoice& choice,
                  const Grid& source,
                  const std::optional<Point3>& world,
                  const MeshReader& mesh,
                  const std::vector<std::int64_t>& steps) {
  return resolve(choice, source, world, [&] {
    IndexBox box;
    for (const std::int64_t step : steps) {
      stop_if_interrupted();
      box.include(index_from_world(source), mesh.mesh(), mesh.read_step(step));
    }
    return grid_of(source, box);
  });
}

Grid resolve_grid(const GridChoice& choice,
                  const Grid& source,
                  const std::optional<Point3>& world,
                  const Mesh& mesh,
                  const std::function<std::vector<Point3>()>& positions) {
  return resolve(choice, source, world, [&] {
    IndexBox box;
    box.include(index_from_world(source), mesh, positions());
    return grid_of(source, box);
  });
}

std::optional<Point3> base_factor(const GridChoice& choice) {
  if (!choice.has_file()) return std::nullopt;
  return itk_factor(choice.base, base_header(choice));
}

void take_base_facts(const GridChoice& choice, std::vector<ArrayHeader>& arrays) {
  if (!choice.has_file()) return;
  const std::optional<NiftiFacts> base = first_facts(base_header(choice));
  for (ArrayHeader& array : arrays) {
    if (!array.nifti) array.nifti = facts_of_extra(base, array.components);
  }
}

Region parse_region(const std::string& text) {
  const std::vector<std::string> ranges = split(text, ',');
  Region region;
  bool valid = ranges.size() == 3;
  for (std::size_t axis = 0; valid && axis < 3; ++axis) {
    const std::vector<std::string> ends = split(ranges[axis], ':');
    valid = ends.size() == 2 && whole_number(ends[0]) && whole_number(ends[1]);
    if (!valid) break;
    region.begin[axis] = *whole_number(ends[0]);
    region.end[axis] = *whole_number(ends[1]);
  }
  if (!valid) {
    throw std::invalid_argument("'" + text +
                                "' is not a region i0:i1,j0:j1,k0:k1 of whole numbers");
  }
  return region;
}

}  // namespace tetwarp::cli
