/// @file image_kind.cpp
/// The first bytes of files.
#include "io/child/image_kind.hpp"

#include <array>
#include <filesystem>
#include <fstream>

namespace tetwarp {
namespace {
/// The first bytes of a file, fewer where it ends before.
std::string first_bytes(const std::string& path) {
  std::array<char, 512> bytes{};
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), bytes.size());
  return {bytes.data(), static_cast<std::size_t>(file.gcount())};
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

}  // namespace tetwarp
