/// @file foreign_image.cpp
/// Kinds by their first bytes, and images from messages of tetwarp-read.
#include "io/child/foreign_image.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <tetwarp/error.hpp>

#include "io/child/reader_program.hpp"

namespace tetwarp {
namespace {
/// The first bytes of a file, fewer where it ends before.
std::string first_bytes(const std::string& path) {
  std::array<char, 512> bytes{};
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), bytes.size());
  return {bytes.data(), static_cast<std::size_t>(file.gcount())};
}

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

bool is_dicom(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return true;
  constexpr std::size_t preamble = 128;
  const std::string bytes = first_bytes(path);
  return bytes.size() >= preamble + 4 && bytes.compare(preamble, 4, "DICM") == 0;
}

bool is_foreign_image(const std::string& path) {
  if (is_dicom(path)) return true;
  const std::string bytes = first_bytes(path);
  const std::size_t element = bytes.find("<VTKFile");
  return element != std::string::npos && bytes.find("\"ImageData\"", element) != std::string::npos;
}

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
    for (std::int64_t k = 0; k < dims[2]; ++k) {
      expect_result(path, message);
      message.read_bytes(slice.data(), slice.size());
      take(slice.data(), slice.size());
    }
  });
}

}  // namespace tetwarp
