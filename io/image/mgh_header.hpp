/// @file mgh_header.hpp
/// Headers of FreeSurfer's images, .mgh and, packed by gzip, .mgz.
#pragma once
#include <string>

#include <tetwarp/volume.hpp>

#include "io/image/image_header.hpp"

namespace tetwarp {

/// True for a name that ends in .mgh, .mgz or .mgh.gz and a file of version 1.
bool is_mgh(const std::string& path);

/// Frames are steps, without times of their own.
/// @throws IoError  about a header that is damaged or of an image that is not read
ImageHeader read_mgh_header(const std::string& path);

/// Bytes before the samples, which are in big-endian order.
constexpr std::int64_t mgh_header_bytes = 284;

/// These bytes.
/// @throws std::invalid_argument  for what the format does not hold: other samples than uint8,
///         int16, uint16, int32 and float32, several components
std::string mgh_header_text(const ImageHeader& header);

}  // namespace tetwarp
