/// @file image_lattice.cpp
/// Finds the foreground, and keeps the tetrahedra that contain some of it.
#include "host/scene/image_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/base/index_space.hpp"
#include "host/scene/checks/scene_checks.hpp"
#include "host/scene/shapes/lattice_search.hpp"
#include "host/scene/volume_rows.hpp"
#include "host/scene/voxel_owner.hpp"
#include "host/scene/voxel_shares.hpp"

namespace tetwarp {
namespace {
/// Shorter edges of cells are small. The number of voxels' centers in a tetrahedron of larger ones
/// differs from its volume by a fifth at most.
constexpr double least_edge = 16;  // [voxel]

/// 1 per voxel of the foreground, of a region of the image.
std::vector<std::uint8_t> foreground_of(const ImageGeometry& image, const Region& region) {
  std::vector<std::uint8_t> flags;
  flags.reserve(static_cast<std::size_t>(region.voxel_count()));
  VolumeRows rows(image.volume, image.threshold);
  for (std::int64_t k = region.begin[2]; k < region.end[2]; ++k) {
    for (std::int64_t j = region.begin[1]; j < region.end[1]; ++j) {
      const auto& row = rows.row(j, k);
      for (std::int64_t i = region.begin[0]; i < region.end[0]; ++i) {
        flags.push_back(row[static_cast<std::size_t>(i)] >= 0);
      }
    }
  }
  return flags;
}

double largest_sample(const Volume& volume) {
  double largest = -std::numeric_limits<double>::infinity();
  VolumeRows rows(volume);
  for (std::int64_t k = 0; k < volume.grid.dims[2]; ++k) {
    for (std::int64_t j = 0; j < volume.grid.dims[1]; ++j) {
      for (const double sample : rows.row(j, k)) largest = std::fmax(largest, sample);
    }
  }
  return largest;
}

bool has_small_cells(const LatticeFrame& frame) {
  const double edge = *std::min_element(frame.edge.begin(), frame.edge.end());
  return edge < least_edge * (1 - 1e-9);
}

/// Places tetrahedra around the foreground and drops those outside it. Positions of frames are
/// index positions of the image.
class ForegroundLattice {
 public:
  ForegroundLattice(const ImageGeometry& image, const Region& box)
      : image_(image), box_(box), foreground_(foreground_of(image, box)) {}

  TetMesh mesh_of(const LatticeFrame& frame) const {
    TetMesh mesh = make_lattice(frame);
    const std::vector<Point3> index_nodes = mesh.nodes;
    map_nodes(mesh, [&](const Point3& x) { return image_.volume.grid.world_of(x); });
    keep_tets(mesh, has_small_cells(frame) ? shares_any(mesh, index_nodes) : owns_any(mesh));
    return mesh;
  }

  /// Of the foreground. @param step  edges of a voxel
  double volume(const Point3& step) const {
    const auto count = std::count(foreground_.begin(), foreground_.end(), std::uint8_t{1});
    return static_cast<double>(count) * step[0] * step[1] * step[2];
  }

 private:
  /// Per tetrahedron whether it owns a voxel of the foreground.
  std::vector<std::uint8_t> owns_any(const TetMesh& mesh) const {
    std::vector<std::uint8_t> owns(mesh.tets.size());
    const std::vector<std::int32_t> owners = voxel_owners(image_.volume, box_, mesh);
    for (std::size_t v = 0; v < owners.size(); ++v) {
      if (owners[v] >= 0 && foreground_[v]) owns[static_cast<std::size_t>(owners[v])] = 1;
    }
    return owns;
  }

  /// Per tetrahedron whether it has a share in a voxel of the foreground.
  std::vector<std::uint8_t> shares_any(const TetMesh& mesh,
                                       const std::vector<Point3>& index_nodes) const {
    std::vector<std::uint8_t> shares;
    shares.reserve(mesh.tets.size());
    for (const auto& [a, b, c, d] : mesh.tets) {
      shares.push_back(has_share(
          {at(index_nodes, a), at(index_nodes, b), at(index_nodes, c), at(index_nodes, d)}, box_,
          [this](const VoxelIndex& voxel) { return is_foreground(voxel); }));
    }
    return shares;
  }

  bool is_foreground(const VoxelIndex& voxel) const {
    std::int64_t place = 0;
    for (std::size_t d = 3; d-- > 0;) {
      place = place * (box_.end[d] - box_.begin[d]) + voxel[d] - box_.begin[d];
    }
    return foreground_[static_cast<std::size_t>(place)] != 0;
  }

  const ImageGeometry& image_;
  Region box_;
  std::vector<std::uint8_t> foreground_;  ///< of the box
};
}  // namespace

Region foreground_box(const std::string& place, const ImageGeometry& image) {
  const auto& dims = image.volume.grid.dims;
  Region box{dims, {0, 0, 0}};
  VolumeRows rows(image.volume, image.threshold);
  for (std::int64_t k = 0; k < dims[2]; ++k) {
    for (std::int64_t j = 0; j < dims[1]; ++j) {
      const auto& row = rows.row(j, k);
      for (std::int64_t i = 0; i < dims[0]; ++i) {
        if (!(row[static_cast<std::size_t>(i)] >= 0)) continue;
        const std::array<std::int64_t, 3> voxel{i, j, k};
        for (std::size_t d = 0; d < 3; ++d) {
          box.begin[d] = std::min(box.begin[d], voxel[d]);
          box.end[d] = std::max(box.end[d], voxel[d] + 1);
        }
      }
    }
  }
  if (box.end[0] == 0) {
    fail_at(key_of(place, "threshold"),
            "no sample of '" + image.volume.name + "' is " + number_text(image.threshold) +
                " or more, the largest is " + number_text(largest_sample(image.volume)) +
                "; lower the threshold");
  }
  return box;
}

ImageLattice make_image_lattice(const std::string& body_place,
                                const ImageGeometry& image,
                                const Lattice& choice) {
  const Grid& grid = image.volume.grid;
  const Region box = foreground_box(key_of(body_place, "volume"), image);
  Bounds bounds;
  Point3 length;
  Point3 step;
  for (std::size_t d = 0; d < 3; ++d) {
    bounds.low[d] = static_cast<double>(box.begin[d]) - 0.5;
    bounds.high[d] = static_cast<double>(box.end[d]) - 0.5;
    step[d] = step_length(grid, d);
    length[d] = (bounds.high[d] - bounds.low[d]) * step[d];
  }
  const ForegroundLattice foreground(image, box);
  const auto frame_of_edge = [&](double edge, double offset) {
    return covering_frame(bounds, {edge / step[0], edge / step[1], edge / step[2]}, offset);
  };
  ChosenLattice chosen = choose_lattice(
      key_of(body_place, "lattice"), choice, bounds, length, foreground.volume(step), frame_of_edge,
      [&](const LatticeFrame& frame) { return foreground.mesh_of(frame); });
  ImageLattice lattice{std::move(chosen.mesh), {}, has_small_cells(chosen.frame)};
  for (std::size_t d = 0; d < 3; ++d) {
    lattice.cells_across[d] = (bounds.high[d] - bounds.low[d]) / chosen.frame.edge[d];
  }
  return lattice;
}

}  // namespace tetwarp
