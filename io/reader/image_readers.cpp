/// @file image_readers.cpp
/// Choice of the library by the content of the file.
#include "io/reader/image_readers.hpp"

#include "io/child/image_kind.hpp"

namespace tetwarp {

ForeignImage read_foreign_image(const std::string& path, const std::string& series) {
  return is_dicom(path) ? read_dicom_image(path, series) : read_vtk_image(path);
}

void read_foreign_samples(const std::string& path,
                          const std::string& array,
                          const std::string& series,
                          const TakeImage& take_image,
                          const TakeSlice& take) {
  if (is_dicom(path)) return read_dicom_samples(path, series, take_image, take);
  read_vtk_samples(path, array, take_image, take);
}

}  // namespace tetwarp
