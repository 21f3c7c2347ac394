/// @file volume.hpp
/// Dense volumes: samples of a numeric type on a regular grid of voxel centers in world space.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/choices.hpp>
#include <tetwarp/export.hpp>
#include <tetwarp/names.hpp>

namespace tetwarp {

/// A position or vector: x, y, z.
using Point3 = std::array<double, 3>;

/// Bytes of one sample.
TETWARP_EXPORT std::size_t size_of(PixelType type);

/// True for the eight integer types.
TETWARP_EXPORT bool is_integer(PixelType type);

/// A regular grid. The center of voxel (i, j, k) is at origin + direction * (spacing o (i, j, k))
/// [world]; o multiplies component by component.
struct TETWARP_EXPORT Grid {
  std::array<std::int64_t, 3> dims{0, 0, 0};  ///< voxels along i, j, k
  Point3 origin{0, 0, 0};                     ///< center of voxel (0, 0, 0) [world]
  Point3 spacing{1, 1, 1};                    ///< distance of centers [world], > 0
  std::array<double, 9> direction{1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row major, invertible

  /// Product of dims.
  std::int64_t voxel_count() const { return dims[0] * dims[1] * dims[2]; }

  /// World position of index-space position `index` (voxel centers are integers).
  Point3 world_of(const Point3& index) const;

  bool operator==(const Grid&) const = default;
};

/// Checks a grid: dims 1 to 2^30 each and fewer than 2^59 voxels, spacing positive and finite,
/// origin finite, direction finite and invertible.
/// @param what  name of the grid in messages
/// @throws std::invalid_argument naming the first violation
TETWARP_EXPORT void check_grid(const Grid& grid, const std::string& what);

/// Half-open range of voxels [begin, end) per axis, in the indices of a grid.
struct Region {
  std::array<std::int64_t, 3> begin{0, 0, 0};  ///< first voxel along i, j, k
  std::array<std::int64_t, 3> end{0, 0, 0};    ///< one past the last voxel along i, j, k

  std::int64_t voxel_count() const {
    return (end[0] - begin[0]) * (end[1] - begin[1]) * (end[2] - begin[2]);
  }

  bool operator==(const Region&) const = default;
};

/// Samples of one array on a grid, stored [k][j][i][component], and their memory.
struct TETWARP_EXPORT Volume {
  Grid grid;
  std::string name = "values";  ///< array name in files; without '/' and '.'
  PixelType type = PixelType::float32;
  int components = 1;           ///< samples per voxel, 1 to 9
  std::vector<std::byte> data;  ///< voxel_count * components * size_of(type) bytes

  /// Size that `data` must have for the grid, the components and the type [byte].
  std::size_t byte_count() const;

  /// The samples as numbers of type T: voxel_count * components of them.
  /// @throws std::invalid_argument when T is not the C++ type of `type`
  template <class T>
  std::span<T> samples() {
    check_type(pixel_type_of<T>());
    return {reinterpret_cast<T*>(data.data()), data.size() / sizeof(T)};
  }
  template <class T>
  std::span<const T> samples() const {
    check_type(pixel_type_of<T>());
    return {reinterpret_cast<const T*>(data.data()), data.size() / sizeof(T)};
  }

 private:
  void check_type(PixelType expected) const;
};

/// A volume of zeros.
/// @throws std::invalid_argument as check_grid(), or when components are not 1 to 9
TETWARP_EXPORT Volume make_volume(const Grid& grid,
                                  PixelType type,
                                  int components = 1,
                                  std::string name = "values");

/// The memory that a pointer refers to.
enum class Memory {
  host,   ///< main memory
  device  ///< memory of the CUDA device that WarpOptions::device names
};

/// Samples that the caller owns, in host memory or on a GPU: [k][j][i][component].
struct TETWARP_EXPORT VolumeView {
  Grid grid;
  PixelType type = PixelType::float32;
  int components = 1;          ///< samples per voxel, 1 to 9
  const void* data = nullptr;  ///< of the voxels of the grid, or of WarpOptions::source_window
  Memory memory = Memory::host;

  VolumeView() = default;
  /// Implicit, so that a Volume can be passed wherever a view is expected.
  /// @throws std::invalid_argument when the volume's data do not have the size that its grid needs
  VolumeView(const Volume& volume);
  VolumeView(const Grid& grid, PixelType type, int components, const void* data, Memory memory);
};

}  // namespace tetwarp
