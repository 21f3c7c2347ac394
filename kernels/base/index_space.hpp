/// @file index_space.hpp
/// Index space of a grid: voxel centers have integer coordinates; node positions are rounded to
/// multiples of a quantum.
#pragma once
#include <cstdint>

namespace tetwarp {

constexpr int quantum_bits = 20;  ///< a quantum is 2^-20 voxel
constexpr std::int64_t quanta_per_voxel = std::int64_t{1} << quantum_bits;
constexpr double max_index = 0x1p40;  ///< [voxel]; nodes with a larger coordinate are rejected

/// World to index space: index = linear * (world - origin), evaluated left to right.
struct IndexFromWorld {
  double linear[3][3];
  double origin[3];
};

}  // namespace tetwarp
