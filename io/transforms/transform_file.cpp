/// @file transform_file.cpp
/// Chooses the reader of a transform.
#include <tetwarp/transform_file.hpp>

#include <algorithm>
#include <tetwarp/io.hpp>
#include <utility>
#include <variant>

#include "io/files/extension.hpp"
#include "io/transforms/field_file.hpp"
#include "io/transforms/fsl_field.hpp"
#include "io/transforms/itk_transform.hpp"
#include "io/transforms/itk_transform_files.hpp"

namespace tetwarp {
namespace {
bool has_transform_name(const std::string& path) {
  return has_extension(path, ".tfm") || has_extension(path, ".txt") || has_extension(path, ".mat");
}

const char* what_of(const Transform& transform) {
  if (std::holds_alternative<AffineTransform>(transform)) return "affine transform";
  if (std::holds_alternative<DisplacementField>(transform)) return "displacement field";
  if (std::holds_alternative<BSplineTransform>(transform)) return "B-spline";
  return "composite";
}
}  // namespace

bool is_transform_file(const std::string& path, const TransformReadOptions& options) {
  if (has_transform_name(path)) return true;
  switch (kind_of(path)) {
    case FileKind::nifti: {
      const NiftiHeader header = read_nifti_header(path);
      return header.components == 3 || is_fsl_field(header, options);
    }
    case FileKind::image:
      return read_volume_header(path).arrays.front().components == 3;
    case FileKind::volume: {
      const std::vector<ArrayHeader> arrays = read_volume_header(path).arrays;
      return std::any_of(arrays.begin(), arrays.end(), [](const ArrayHeader& array) {
        return array.name == "tetwarp_displacement";
      });
    }
    case FileKind::hdf5:
      return is_itk_hdf5(path);
    default:
      return false;
  }
}

TransformFile read_transform(const std::string& path, const TransformReadOptions& options) {
  if (!has_transform_name(path)) {
    switch (kind_of(path)) {
      case FileKind::nifti:
        return is_fsl_field(read_nifti_header(path), options)
                   ? read_fsl_field(path, options)
                   : read_nifti_field(path, options.axes);
      case FileKind::image:
        return read_image_field(path, options.axes);
      case FileKind::hdf5:
        break;
      default:
        return read_volume_field(path);
    }
  }
  Transform transform = transform_of(path, has_extension(path, ".mat") ? read_itk_matlab(path)
                                           : has_transform_name(path)  ? read_itk_text(path)
                                                                       : read_itk_hdf5(path));
  std::string convention = std::string(what_of(transform)) + " of ITK along LPS axes";
  return {std::move(transform), std::move(convention)};
}

}  // namespace tetwarp
