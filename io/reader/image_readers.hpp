/// @file image_readers.hpp
/// The readers of images of other programs, one per library.
#pragma once
#include <string>

#include "io/child/foreign_image.hpp"

namespace tetwarp {

/// Of GDCM and of VTK. In a build without the library they throw an IoError that names it.
/// @param path    a DICOM file, or a folder of them; a .vti file
/// @param series  UID of the series to read; empty: the only one
ForeignImage read_dicom_image(const std::string& path, const std::string& series);
ForeignImage read_vtk_image(const std::string& path);

/// Read the samples of an array, slice by slice along k, after the image that they belong to.
void read_dicom_samples(const std::string& path,
                        const std::string& series,
                        const TakeImage& take_image,
                        const TakeSlice& take);
void read_vtk_samples(const std::string& path,
                      const std::string& array,
                      const TakeImage& take_image,
                      const TakeSlice& take);

/// Read an image, or its samples, by the library of its format.
ForeignImage read_foreign_image(const std::string& path, const std::string& series);
void read_foreign_samples(const std::string& path,
                          const std::string& array,
                          const std::string& series,
                          const TakeImage& take_image,
                          const TakeSlice& take);

}  // namespace tetwarp
