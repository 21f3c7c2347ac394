/// @file image_header.hpp
/// What the headers of NRRD files and of MetaImages tell alike.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/volume.hpp>

namespace tetwarp {

/// An image whose samples are stored [k][j][i][component].
struct ImageHeader {
  Grid grid;  ///< in RAS
  PixelType type = PixelType::uint8;
  int components = 1;
  std::string data_file;         ///< that holds the samples; may be the header's own
  std::int64_t data_offset = 0;  ///< of the samples; -1: they are the last bytes of the file
  bool is_packed = false;        ///< by zlib or gzip
  bool is_big_endian = false;
  std::vector<std::string> left_out = {};  ///< other fields of the header

  std::size_t voxel_bytes() const { return static_cast<std::size_t>(components) * size_of(type); }
};

/// Sets spacing and direction from the steps along the grid's axes, and turns them and the origin
/// to RAS.
/// @param is_negated  by axis of the world: whether the file's axis points the other way
/// @throws std::invalid_argument  as check_grid()
void set_image_axes(const std::array<Point3, 3>& steps,
                    const Point3& origin,
                    const std::array<bool, 3>& is_negated,
                    Grid& grid);

/// A file in the folder of another one, unless its path is absolute.
std::string beside(const std::string& file, const std::string& name);

}  // namespace tetwarp
