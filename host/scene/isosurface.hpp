/// @file isosurface.hpp
/// The surface of an image's foreground.
#pragma once
#include <cstdint>
#include <string>

#include <tetwarp/scene.hpp>

namespace tetwarp {

/// The isosurface at the threshold, by marching tetrahedra on the voxels' centers: closed, also
/// where the foreground reaches the border of the image: there it ends half a voxel beyond the
/// outermost centers. Points keep 0.02 of a lattice edge from voxels' centers, so that no triangle
/// is without area.
/// @param place  of the volume, for messages
/// @throws std::invalid_argument  no foreground, too many triangles
Surface make_isosurface(const std::string& place, const ImageGeometry& image);

/// The same of about `triangles` triangles, or fewer if the image has fewer: sampled on a coarser
/// lattice; its points are on the surface of the interpolated image. Parts that the coarser lattice
/// does not sample are missing.
Surface make_isosurface(const std::string& place,
                        const ImageGeometry& image,
                        std::int64_t triangles);

}  // namespace tetwarp
