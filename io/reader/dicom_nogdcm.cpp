/// @file dicom_nogdcm.cpp
/// In place of dicom_gdcm.cpp where GDCM was missing when this was built.
#include <tetwarp/missing_library.hpp>

#include "io/reader/image_readers.hpp"

namespace tetwarp {

ForeignImage read_dicom_image(const std::string& path, const std::string&) {
  throw MissingLibrary(path, "GDCM",
                       "this build cannot read DICOM; install libgdcm-dev and build again, or "
                       "convert to NIfTI, for example by dcm2niix");
}

void read_dicom_samples(const std::string& path,
                        const std::string& series,
                        const TakeImage&,
                        const TakeSlice&) {
  read_dicom_image(path, series);
}

}  // namespace tetwarp
