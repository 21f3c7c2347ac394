/// @file voxel_owner.cpp
/// Warps a volume of zeros on the grid of the image with its mesh at rest, which writes the owners.
#include "host/scene/voxel_owner.hpp"

#include <algorithm>
#include <cstddef>
#include <tetwarp/warp.hpp>

#include "host/scene/volume_rows.hpp"
#include "host/scene/voxel_shares.hpp"

namespace tetwarp {

std::vector<std::int32_t> voxel_owners(const Volume& volume,
                                       const Region& region,
                                       const TetMesh& mesh) {
  const auto voxel_count = static_cast<std::size_t>(region.voxel_count());
  std::vector<std::int32_t> owners(voxel_count, -1);
  if (mesh.tets.empty()) return owners;
  WarpOptions options;
  options.filter = Filter::nearest;
  options.region = region;
  options.backend = Backend::cpu;
  // Samples are written as well: those of zeros in one byte take the least time.
  const Volume zeros = make_volume(volume.grid, PixelType::uint8);
  Warper warper(zeros, {mesh.nodes, mesh.tets}, options);
  std::vector<std::byte> samples(voxel_count);
  void* const target = samples.data();
  warper.step(mesh.nodes, {.volumes = {&target, 1}, .owner = owners.data()});
  return owners;
}

std::vector<std::int32_t> tets_of_value(const Volume& volume,
                                        const BodyGeometry& geometry,
                                        double value) {
  const Region whole{{0, 0, 0}, volume.grid.dims};
  std::vector<std::int32_t> tets;
  if (geometry.shares_voxels) {
    const std::vector<Point3> nodes = index_positions(volume.grid, geometry.nodes);
    for (std::size_t t = 0; t < geometry.tets.size(); ++t) {
      const auto& [a, b, c, d] = geometry.tets[t];
      const auto has_value = [&](const VoxelIndex& voxel) {
        return sample_of(volume, voxel) == value;
      };
      if (has_share({at(nodes, a), at(nodes, b), at(nodes, c), at(nodes, d)}, whole, has_value)) {
        tets.push_back(static_cast<std::int32_t>(t));
      }
    }
    return tets;
  }
  const auto owners = voxel_owners(volume, whole, {geometry.nodes, geometry.tets});
  std::vector<std::uint8_t> owns(geometry.tets.size());
  VolumeRows rows(volume);
  std::size_t voxel = 0;
  for (std::int64_t k = 0; k < volume.grid.dims[2]; ++k) {
    for (std::int64_t j = 0; j < volume.grid.dims[1]; ++j) {
      for (const double sample : rows.row(j, k)) {
        const std::int32_t owner = owners[voxel++];
        if (owner >= 0 && sample == value) owns[static_cast<std::size_t>(owner)] = 1;
      }
    }
  }
  for (std::size_t t = 0; t < owns.size(); ++t) {
    if (owns[t]) tets.push_back(static_cast<std::int32_t>(t));
  }
  return tets;
}

}  // namespace tetwarp
