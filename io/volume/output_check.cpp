/// @file output_check.cpp
/// The checks of each format.
#include "io/volume/output_check.hpp"

#include "io/image/image_write.hpp"
#include "io/image/vti_write.hpp"
#include "io/nifti/nifti_write.hpp"
#include "io/vtkhdf/vtkhdf_image.hpp"

namespace tetwarp {

void check_volume_output(const std::string& path,
                         const Grid& grid,
                         const std::vector<ArrayHeader>& arrays,
                         const VolumeWriteOptions& options,
                         bool is_temporal) {
  if (has_nifti_name(path)) return check_nifti(path, grid, arrays);
  if (has_image_name(path)) return check_image(path, grid, arrays, options);
  if (has_vtk_image_name(path)) return check_vti(path, grid, arrays, is_temporal);
  check_image_file(path, grid, arrays, options);
}

}  // namespace tetwarp
