/// @file nrrd_header.hpp
/// Headers of NRRD files, attached (.nrrd) and detached (.nhdr).
#pragma once
#include <string>

#include <tetwarp/volume.hpp>

#include "io/image/image_header.hpp"

namespace tetwarp {

bool is_nrrd(const std::string& path);

/// @throws IoError  about a header that is damaged or of an image that is not read
ImageHeader read_nrrd_header(const std::string& path);

/// A header that is followed by the samples, in little-endian order.
std::string nrrd_header_text(const ImageHeader& header);

}  // namespace tetwarp
