/// @file transform_file.cpp
/// Chooses the reader of a transform.
#include <tetwarp/transform_file.hpp>

#include <algorithm>
#include <tetwarp/io.hpp>

#include "io/files/extension.hpp"
#include "io/transforms/field_file.hpp"
#include "io/transforms/itk_transform.hpp"

namespace tetwarp {
namespace {
bool has_transform_name(const std::string& path) {
  return has_extension(path, ".tfm") || has_extension(path, ".txt") || has_extension(path, ".mat");
}
}  // namespace

bool is_transform_file(const std::string& path) {
  if (has_transform_name(path)) return true;
  switch (kind_of(path)) {
    case FileKind::nifti:
    case FileKind::image:
      return read_volume_header(path).arrays.front().components == 3;
    case FileKind::volume: {
      const std::vector<ArrayHeader> arrays = read_volume_header(path).arrays;
      return std::any_of(arrays.begin(), arrays.end(), [](const ArrayHeader& array) {
        return array.name == "tetwarp_displacement";
      });
    }
    default:
      return false;
  }
}

TransformFile read_transform(const std::string& path, const std::optional<Axes>& axes) {
  if (!has_transform_name(path)) {
    const FileKind kind = kind_of(path);
    return kind == FileKind::nifti   ? read_nifti_field(path, axes)
           : kind == FileKind::image ? read_image_field(path, axes)
                                     : read_volume_field(path);
  }
  const bool is_matlab = has_extension(path, ".mat");
  return {affine_of(path, is_matlab ? read_itk_matlab(path) : read_itk_text(path)),
          "affine transform of ITK along LPS axes"};
}

}  // namespace tetwarp
