/// @file mgh_header.cpp
/// Big-endian numbers at fixed places;
/// https://surfer.nmr.mgh.harvard.edu/fswiki/FsTutorial/MghFormat
#include "io/image/mgh_header.hpp"

#include <znzlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <tetwarp/error.hpp>

#include "io/files/extension.hpp"
#include "io/nifti/nifti_header.hpp"

namespace tetwarp {
namespace {
using HeaderBytes = std::array<char, mgh_header_bytes>;

struct MghType {
  std::int32_t code;
  PixelType type;
};
constexpr MghType mgh_types[] = {{0, PixelType::uint8},
                                 {1, PixelType::int32},
                                 {3, PixelType::float32},
                                 {4, PixelType::int16},
                                 {10, PixelType::uint16}};

/// Places of numbers in the header [byte].
constexpr std::size_t version_place = 0, size_place = 4, type_place = 20, flag_place = 28,
                      spacing_place = 30, direction_place = 42, center_place = 78;

bool is_packed_name(const std::string& path) {
  return has_extension(path, ".mgz") || has_extension(path, ".mgh.gz");
}

template <class T>
T number_at(const HeaderBytes& bytes, std::size_t place) {
  std::array<char, sizeof(T)> part;
  std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(place), sizeof(T), part.begin());
  if constexpr (std::endian::native == std::endian::little) std::ranges::reverse(part);
  return std::bit_cast<T>(part);
}

template <class T>
void set_number(std::string& bytes, std::size_t place, T number) {
  auto part = std::bit_cast<std::array<char, sizeof(T)>>(number);
  if constexpr (std::endian::native == std::endian::little) std::ranges::reverse(part);
  std::ranges::copy(part, bytes.begin() + static_cast<std::ptrdiff_t>(place));
}

/// The header of a file, plain or packed; nothing when it is shorter.
std::optional<HeaderBytes> header_of(const std::string& path) {
  NiftiStream stream(path, "rb", true);
  HeaderBytes bytes;
  if (!stream || !stream.read(bytes.data(), bytes.size())) return std::nullopt;
  return bytes;
}

/// Center of the middle voxel, which files without a direction have at the origin of the world.
Point3 middle_of(const std::array<std::int64_t, 3>& dims) {
  Point3 middle;
  for (std::size_t axis = 0; axis < 3; ++axis) middle[axis] = static_cast<double>(dims[axis]) / 2;
  return middle;
}

/// Whether scan parameters and tags follow the samples: of a packed file by the length that gzip
/// stores, modulo 2^32.
bool has_footer(const std::string& path, const ImageHeader& header) {
  const auto end =
      static_cast<std::uint64_t>(mgh_header_bytes) +
      static_cast<std::uint64_t>(header.grid.voxel_count() * header.steps) * header.voxel_bytes();
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!header.is_packed) return !error && size > end;
  std::ifstream file(path, std::ios::binary);
  std::array<unsigned char, 4> length{};
  file.seekg(-4, std::ios::end);
  if (!file.read(reinterpret_cast<char*>(length.data()), 4)) return false;
  const std::uint32_t stored = length[0] | std::uint32_t{length[1]} << 8 |
                               std::uint32_t{length[2]} << 16 | std::uint32_t{length[3]} << 24;
  return stored != static_cast<std::uint32_t>(end);
}
}  // namespace

bool is_mgh(const std::string& path) {
  if (!has_extension(path, ".mgh") && !is_packed_name(path)) return false;
  const auto bytes = header_of(path);
  return bytes && number_at<std::int32_t>(*bytes, version_place) == 1;
}

ImageHeader read_mgh_header(const std::string& path) {
  const auto found = header_of(path);
  if (!found) throw IoError(path, "", "is no image of FreeSurfer: its header is cut off");
  const HeaderBytes& bytes = *found;
  ImageHeader header;
  std::ifstream file(path, std::ios::binary);
  header.is_packed = file.get() == 0x1f && file.get() == 0x8b;
  header.data_file = path;
  header.data_offset = header.is_packed ? 0 : mgh_header_bytes;
  header.skipped = header.is_packed ? mgh_header_bytes : 0;
  header.is_big_endian = true;
  const auto code = number_at<std::int32_t>(bytes, type_place);
  const auto* const type = std::ranges::find(mgh_types, code, &MghType::code);
  if (type == std::end(mgh_types)) {
    throw IoError(path, "type",
                  "is " + std::to_string(code) +
                      ", expected 0, 1, 3, 4 or 10: bytes, integers or "
                      "floats; convert it by mri_convert");
  }
  header.type = type->type;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    header.grid.dims[axis] = number_at<std::int32_t>(bytes, size_place + 4 * axis);
  }
  // Without the flag: 1 mm, coronal slices.
  std::array<Point3, 3> steps{{{-1, 0, 0}, {0, 0, -1}, {0, 1, 0}}};
  Point3 origin{0, 0, 0};
  if (number_at<std::int16_t>(bytes, flag_place) > 0) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double spacing = number_at<float>(bytes, spacing_place + 4 * axis);
      for (std::size_t row = 0; row < 3; ++row) {
        steps[axis][row] = spacing * number_at<float>(bytes, direction_place + 12 * axis + 4 * row);
      }
      origin[axis] = number_at<float>(bytes, center_place + 4 * axis);
    }
  }
  const Point3 middle = middle_of(header.grid.dims);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t row = 0; row < 3; ++row) origin[row] -= middle[axis] * steps[axis][row];
  }
  try {
    set_image_axes(steps, origin, {false, false, false}, header.grid);
    const auto frames = number_at<std::int32_t>(bytes, size_place + 12);
    if (frames != 1) set_image_steps(frames, 0, 1, header);
  } catch (const std::invalid_argument& error) {
    throw IoError(path, "", error.what());
  }
  if (has_footer(path, header)) {
    header.left_out = {"what follows the samples (scan parameters, tags)"};
  }
  return header;
}

std::string mgh_header_text(const ImageHeader& header) {
  const auto* const type = std::ranges::find(mgh_types, header.type, &MghType::type);
  if (type == std::end(mgh_types)) {
    throw std::invalid_argument(std::string("holds no ") + name_of(header.type) +
                                "; write .nii.gz, .nrrd or .mha");
  }
  if (header.components > 1) {
    throw std::invalid_argument("holds one number per voxel; write .nii.gz, .nrrd or .mha");
  }
  std::string bytes(mgh_header_bytes, '\0');
  set_number<std::int32_t>(bytes, version_place, 1);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    set_number(bytes, size_place + 4 * axis, static_cast<std::int32_t>(header.grid.dims[axis]));
  }
  set_number(bytes, size_place + 12, static_cast<std::int32_t>(header.steps));
  set_number(bytes, type_place, type->code);
  set_number<std::int16_t>(bytes, flag_place, 1);
  const Point3 center = header.grid.world_of(middle_of(header.grid.dims));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    set_number(bytes, spacing_place + 4 * axis, static_cast<float>(header.grid.spacing[axis]));
    for (std::size_t row = 0; row < 3; ++row) {
      set_number(bytes, direction_place + 12 * axis + 4 * row,
                 static_cast<float>(header.grid.direction[3 * row + axis]));
    }
    set_number(bytes, center_place + 4 * axis, static_cast<float>(center[axis]));
  }
  return bytes;
}

}  // namespace tetwarp
