/// @file nifti_grid.hpp
/// The maps from voxels to the world in a NIfTI header.
#pragma once
#include <string>

#include <tetwarp/nifti.hpp>

#include "io/nifti/nifti_fields.hpp"

namespace tetwarp {

/// The grid of an image: of its sform, else of its qform, else of its voxel sizes.
/// @param path  for messages
/// @throws IoError naming the field when the map is not finite or not invertible, or holds a shear
///         that no grid holds
Grid grid_of(const std::string& path, const NiftiFields& fields);

/// True when both forms place the corners of the image within 0.01 voxel of each other.
bool forms_agree(const NiftiFields& fields, const Grid& grid);

/// Stores a grid as sform and qform. A form whose code is 0 is left out if the other one, or the
/// voxel sizes alone, hold the grid; the qform also where the axes are not perpendicular.
void set_grid(NiftiFields& fields, const Grid& grid, const NiftiFacts& facts);

}  // namespace tetwarp
