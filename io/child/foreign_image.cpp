/// @file foreign_image.cpp
/// Images from messages of tetwarp-read.
#include "io/child/foreign_image.hpp"

#include <algorithm>
#include <stdexcept>
#include <tetwarp/error.hpp>

#include "io/child/reader_program.hpp"

namespace tetwarp {
namespace {
/// Checks what a reader has returned. Throws IoError.
void check_image(const std::string& path, const ForeignImage& image) {
  try {
    check_grid(image.grid, "grid");
  } catch (const std::invalid_argument& error) {
    throw IoError(path, "", std::string(error.what()) + ": damaged, write it again");
  }
  for (const ForeignArray& array : image.arrays) {
    if (array.type < PixelType::uint8 || array.type > PixelType::float64) {
      throw IoError(path, array.name, "has samples of no known type: damaged, write it again");
    }
    if (array.components < 1 || array.components > 9) {
      throw IoError(path, array.name,
                    "has " + std::to_string(array.components) + " components, expected 1 to 9");
    }
  }
  const auto is_active = [&](const ForeignArray& array) { return array.name == image.active; };
  if (std::ranges::none_of(image.arrays, is_active)) {
    throw IoError(path, "", "holds no array of numbers at its voxels; write it with point data");
  }
}
}  // namespace

ForeignImage read_image_in_child(const std::string& path, const std::string& series) {
  ForeignImage image;
  run_reader(path, {"image", series}, limits_for(path), [&](auto& message) { message(image); });
  check_image(path, image);
  return image;
}

void read_samples_in_child(const std::string& path,
                           const std::string& series,
                           const ForeignImage& image,
                           const std::string& array,
                           const TakeSlice& take) {
  const auto found = std::ranges::find(image.arrays, array, &ForeignArray::name);
  if (found == image.arrays.end()) throw IoError(path, array, "no such array");
  const auto& dims = image.grid.dims;
  std::vector<std::byte> slice(static_cast<std::size_t>(dims[0] * dims[1] * found->components) *
                               size_of(found->type));
  run_reader(path, {"samples", array, series}, limits_for(path), [&](auto& message) {
    ForeignImage now;
    message(now);
    if (now.grid != image.grid || now.arrays != image.arrays) {
      throw IoError(path, "", "has changed while it was read; read it again");
    }
    for (std::int64_t k = 0; k < dims[2]; ++k) {
      expect_result(path, message);
      message.read_bytes(slice.data(), slice.size());
      take(slice.data(), slice.size());
    }
  });
}

}  // namespace tetwarp
