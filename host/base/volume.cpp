/// @file volume.cpp
/// Volumes and views of them, and the maps between indices and the world.
#include <sys/mman.h>
#include <unistd.h>

#include <Eigen/LU>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <tetwarp/volume.hpp>
#include <utility>

#include "host/base/index_space.hpp"

namespace tetwarp {
namespace {
using RowMatrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

/// Advises the system to use huge pages for memory not yet touched: accesses across a volume would
/// enter a new small page every few voxels. Has no effect where the system does not support them.
void ask_for_huge_pages(std::byte* memory, std::size_t size) {
  constexpr std::size_t huge_page = std::size_t{2} << 20;
  if (size < 2 * huge_page) return;  // may not contain an aligned huge page
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const auto address = reinterpret_cast<std::uintptr_t>(memory);
  const std::uintptr_t skipped = (page - address % page) % page;
  ::madvise(memory + skipped, (size - skipped) / page * page, MADV_HUGEPAGE);
}

RowMatrix world_from_index(const Grid& grid) {
  return Eigen::Map<const RowMatrix>(grid.direction.data()) *
         Eigen::Map<const Eigen::Vector3d>(grid.spacing.data()).asDiagonal();
}

/// Rounds x to the nearest integer when it is closer than 2^-40.
double snapped(double x) {
  const double whole = std::nearbyint(x);
  return std::abs(x - whole) < 0x1p-40 ? whole : x;
}
}  // namespace

std::size_t size_of(PixelType type) {
  static constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return sizes[static_cast<int>(type)];
}

bool is_integer(PixelType type) {
  return type < PixelType::float32;
}

Point3 Grid::world_of(const Point3& index) const {
  Point3 world = origin;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      world[row] += direction[3 * row + axis] * spacing[axis] * index[axis];
    }
  }
  return world;
}

void check_grid(const Grid& grid, const std::string& what) {
  double product = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string on_axis = " on axis " + std::to_string(axis);
    if (grid.dims[axis] < 1 || grid.dims[axis] > (std::int64_t{1} << 30)) {
      throw std::invalid_argument(what + ": " + std::to_string(grid.dims[axis]) + " voxels" +
                                  on_axis + ", expected 1 to 2^30");
    }
    if (!(grid.spacing[axis] > 0) || !std::isfinite(grid.spacing[axis])) {
      throw std::invalid_argument(what + ": spacing " + std::to_string(grid.spacing[axis]) +
                                  on_axis + ", expected a positive number");
    }
    if (!std::isfinite(grid.origin[axis])) {
      throw std::invalid_argument(what + ": origin is not finite" + on_axis);
    }
    product *= static_cast<double>(grid.dims[axis]);
  }
  if (product >= 0x1p59) {
    throw std::invalid_argument(what + ": more than 2^59 voxels");
  }
  for (const double entry : grid.direction) {
    if (!std::isfinite(entry)) {
      throw std::invalid_argument(what + ": direction is not finite");
    }
  }
  // Columns may have any length, but must be linearly independent.
  const RowMatrix direction = Eigen::Map<const RowMatrix>(grid.direction.data());
  const double scale = direction.colwise().norm().prod();
  if (!(std::abs(direction.determinant()) > 1e-6 * scale)) {
    throw std::invalid_argument(what + ": direction is singular, expected three independent axes");
  }
}

std::size_t Volume::byte_count() const {
  return static_cast<std::size_t>(grid.voxel_count()) * static_cast<std::size_t>(components) *
         size_of(type);
}

void Volume::check_type(PixelType expected) const {
  if (expected != type) {
    throw std::invalid_argument("volume '" + name + "' holds " + name_of(type) + ", not " +
                                name_of(expected));
  }
}

Volume make_volume(const Grid& grid, PixelType type, int components, std::string name) {
  check_grid(grid, "volume");
  if (components < 1 || components > 9) {
    throw std::invalid_argument("volume: " + std::to_string(components) +
                                " components, expected 1 to 9");
  }
  Volume volume;
  volume.grid = grid;
  volume.name = std::move(name);
  volume.type = type;
  volume.components = components;
  volume.data.reserve(volume.byte_count());
  ask_for_huge_pages(volume.data.data(), volume.data.capacity());
  volume.data.resize(volume.byte_count());
  return volume;
}

VolumeView::VolumeView(const Volume& volume)
    : grid(volume.grid),
      type(volume.type),
      components(volume.components),
      data(volume.data.data()) {
  if (volume.data.size() != volume.byte_count()) {
    throw std::invalid_argument("volume '" + volume.name + "' holds " +
                                std::to_string(volume.data.size()) + " bytes, its grid needs " +
                                std::to_string(volume.byte_count()));
  }
}

VolumeView::VolumeView(const Grid& view_grid,
                       PixelType sample_type,
                       int component_count,
                       const void* samples,
                       Memory where)
    : grid(view_grid),
      type(sample_type),
      components(component_count),
      data(samples),
      memory(where) {}

IndexFromWorld index_from_world(const Grid& grid) {
  const RowMatrix inverse = Eigen::PartialPivLU<RowMatrix>(world_from_index(grid)).inverse();
  IndexFromWorld result;
  for (int row = 0; row < 3; ++row) {
    result.origin[row] = grid.origin[static_cast<std::size_t>(row)];
    for (int axis = 0; axis < 3; ++axis) result.linear[row][axis] = inverse(row, axis);
  }
  return result;
}

IndexMap source_from_output(const Grid& source, const Grid& output) {
  const RowMatrix inverse = Eigen::PartialPivLU<RowMatrix>(world_from_index(source)).inverse();
  const RowMatrix linear = inverse * world_from_index(output);
  const Eigen::Vector3d apart = Eigen::Map<const Eigen::Vector3d>(output.origin.data()) -
                                Eigen::Map<const Eigen::Vector3d>(source.origin.data());
  const Eigen::Vector3d offset = inverse * apart;
  bool is_shift = true;
  IndexMap map;
  for (int row = 0; row < 3; ++row) {
    const std::size_t r = static_cast<std::size_t>(row);
    map.offset[r] = snapped(offset(row));
    is_shift = is_shift && map.offset[r] == std::nearbyint(map.offset[r]);
    for (int axis = 0; axis < 3; ++axis) {
      const double entry = linear(row, axis);
      const double identity = row == axis ? 1.0 : 0.0;
      map.linear[3 * r + static_cast<std::size_t>(axis)] = entry;
      is_shift = is_shift && std::abs(entry - identity) < 0x1p-40;
    }
  }
  if (is_shift) map.linear = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  return map;
}

}  // namespace tetwarp
