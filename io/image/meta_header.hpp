/// @file meta_header.hpp
/// Headers of MetaImages, ITK's .mha and .mhd.
#pragma once
#include <string>

#include <tetwarp/volume.hpp>

#include "io/image/image_header.hpp"

namespace tetwarp {

/// True for text that begins as such a header and a name that ends in .mha or .mhd.
bool is_meta_image(const std::string& path);

/// @throws IoError  about a header that is damaged or of an image that is not read
ImageHeader read_meta_header(const std::string& path);

/// A header of samples in little-endian order, which follow it if its data_file is empty.
std::string meta_header_text(const ImageHeader& header);

}  // namespace tetwarp
