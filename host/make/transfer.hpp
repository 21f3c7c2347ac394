/// @file transfer.hpp
/// Samples of volumes, and the color and extinction that a transfer function gives them.
#pragma once
#include <array>

#include <tetwarp/cast.hpp>

namespace tetwarp {

/// What a ray meets at a point.
struct Matter {
  std::array<double, 3> color{};
  double extinction = 0;  ///< [1/world]; infinite where nothing behind is seen
};

/// @throws std::invalid_argument  on a function without points, values that do not ascend, numbers
///                                out of range
void check_transfer(const TransferFunction& function);

Matter matter_of(const TransferFunction& function, double value);

/// Whether all values from `low` to `high` have opacity 0.
bool is_clear(const TransferFunction& function, double low, double high);

/// The number that is drawn for a voxel: its sample or, of several components, their Euclidean
/// norm.
double value_at(const Volume& volume, std::int64_t voxel);

/// The same, interpolated at a position in index space; constant beyond the outermost centers.
double sample_at(const Volume& volume, const Point3& index);

}  // namespace tetwarp
