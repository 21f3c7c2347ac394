/// @file image_kind.hpp
/// Which images the program tetwarp-read reads, by their content.
#pragma once
#include <string>

namespace tetwarp {

/// Whether a file, or a folder, is one that the program reads as an image: by content.
bool is_foreign_image(const std::string& path);

/// Whether it is a DICOM file or a folder.
bool is_dicom(const std::string& path);

}  // namespace tetwarp
