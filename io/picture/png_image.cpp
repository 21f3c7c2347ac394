/// @file png_image.cpp
/// Pictures as PNG files.
#include <png.h>

#include <tetwarp/io.hpp>

#include "io/files/finished_file.hpp"

namespace tetwarp {

void write_png(const std::string& path, const Image& image) {
  const bool is_sized =
      image.width > 0 && image.height > 0 && image.width <= 65535 && image.height <= 65535;
  const std::size_t row = 3 * static_cast<std::size_t>(is_sized ? image.width : 0);
  if (!is_sized || image.rgb.size() != row * static_cast<std::size_t>(image.height)) {
    throw IoError(path, "",
                  "a picture of " + std::to_string(image.width) + " x " +
                      std::to_string(image.height) + " pixels with " +
                      std::to_string(image.rgb.size()) +
                      " bytes; expected 1 to 65535 each way and 3 bytes per pixel");
  }
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  FinishedFile file(path);
  if (png_image_write_to_file(&png, file.temporary().c_str(), 0, image.rgb.data(),
                              static_cast<png_int_32>(row), nullptr) == 0) {
    throw IoError(path, "", std::string("cannot be written: ") + png.message);
  }
  file.finish();
}

}  // namespace tetwarp
