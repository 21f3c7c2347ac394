/// @file nifti_grid.cpp
/// A grid from sizes, qform or sform, and both forms of a grid.
#include "io/nifti/nifti_grid.hpp"

#include <nifti1.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <tetwarp/error.hpp>

namespace tetwarp {
namespace {
/// Row by row: three factors of the index, then the origin.
using Map = std::array<std::array<double, 4>, 3>;

/// Size of a voxel along an axis, 0 to 2. Zero stands for one, as other readers take it.
double voxel_size(const NiftiFields& fields, std::size_t axis) {
  const double size = fields.pixdim[axis + 1];
  return size == 0 ? 1 : size;
}

Map map_of_sizes(const NiftiFields& fields) {
  Map map{};
  for (std::size_t axis = 0; axis < 3; ++axis) map[axis][axis] = voxel_size(fields, axis);
  return map;
}

/// The rotation of a unit quaternion (a, b, c, d), a >= 0, with the third axis mirrored where
/// pixdim[0] is negative.
Map map_of_qform(const NiftiFields& fields) {
  double b = fields.quatern[0], c = fields.quatern[1], d = fields.quatern[2];
  double a = 1 - (b * b + c * c + d * d);
  if (a < 1e-7) {  // half a turn, up to rounding
    const double length = std::sqrt(b * b + c * c + d * d);
    b /= length;
    c /= length;
    d /= length;
    a = 0;
  } else {
    a = std::sqrt(a);
  }
  const double rotation[3][3] = {
      {a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)},
      {2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)},
      {2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - c * c - b * b}};
  Map map{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double sign = axis == 2 && fields.pixdim[0] < 0 ? -1 : 1;
      map[row][axis] = sign * rotation[row][axis] * voxel_size(fields, axis);
    }
    map[row][3] = fields.qoffset[row];
  }
  return map;
}

bool is_finite(const Map& map) {
  return std::ranges::all_of(map, [](const std::array<double, 4>& row) {
    return std::ranges::all_of(row, [](double value) { return std::isfinite(value); });
  });
}

/// Checks the sizes of voxels, which qform and the plain map use.
void check_sizes(const std::string& path, const NiftiFields& fields) {
  for (std::size_t axis = 1; axis <= 3; ++axis) {
    const double size = fields.pixdim[axis];
    if (std::isfinite(size) && size >= 0) continue;
    throw IoError(
        path, "pixdim[" + std::to_string(axis) + "]",
        "is " + std::to_string(size) + ", expected the size of a voxel; correct the header");
  }
}

/// Checks that the quaternion is of length 1, of which the three stored numbers are a part.
void check_quaternion(const std::string& path, const NiftiFields& fields) {
  const double b = fields.quatern[0], c = fields.quatern[1], d = fields.quatern[2];
  const double square = b * b + c * c + d * d;
  if (!(square > 1 + 1e-3)) return;  // the rest: rounding of other programs
  throw IoError(path, "qform",
                "has a quaternion of length " + std::to_string(std::sqrt(square)) +
                    ", expected at most 1; correct the header");
}

/// True when voxel sizes alone give the grid: no form is needed.
bool is_plain(const Grid& grid) {
  return grid.origin == Point3{0, 0, 0} && grid.direction == Grid{}.direction;
}

bool is_orthonormal(const Grid& grid) {
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      double dot = 0;
      for (std::size_t row = 0; row < 3; ++row) {
        dot += grid.direction[3 * row + a] * grid.direction[3 * row + b];
      }
      if (std::abs(dot - (a == b ? 1.0 : 0.0)) > 1e-5) return false;
    }
  }
  return true;
}

/// Stores a rotation, or a rotation and a mirrored third axis, as quaternion and sign.
void set_quaternion(NiftiFields& fields, const std::array<double, 9>& direction) {
  std::array<double, 9> r = direction;
  const double determinant = r[0] * (r[4] * r[8] - r[5] * r[7]) -
                             r[1] * (r[3] * r[8] - r[5] * r[6]) +
                             r[2] * (r[3] * r[7] - r[4] * r[6]);
  fields.pixdim[0] = determinant < 0 ? -1 : 1;
  for (std::size_t row = 0; row < 3; ++row) r[3 * row + 2] *= fields.pixdim[0];
  // The largest of the four is computed from a root, the others from it: no small divisor.
  const double squares[4] = {1 + r[0] + r[4] + r[8], 1 + r[0] - r[4] - r[8], 1 - r[0] + r[4] - r[8],
                             1 - r[0] - r[4] + r[8]};
  const auto largest = std::ranges::max_element(squares) - squares;
  const double root = std::sqrt(squares[largest]);
  const double sums[4][4] = {{root * root, r[7] - r[5], r[2] - r[6], r[3] - r[1]},
                             {r[7] - r[5], root * root, r[1] + r[3], r[2] + r[6]},
                             {r[2] - r[6], r[1] + r[3], root * root, r[5] + r[7]},
                             {r[3] - r[1], r[2] + r[6], r[5] + r[7], root * root}};
  const double sign = sums[largest][0] < 0 ? -1 : 1;
  double length = 0;
  for (const double sum : sums[largest]) length += sum * sum;
  length = std::sqrt(length);
  for (std::size_t n = 0; n < 3; ++n) fields.quatern[n] = sign * sums[largest][n + 1] / length;
}
}  // namespace

Grid grid_of(const std::string& path, const NiftiFields& fields) {
  const bool has_sform = fields.sform_code > 0;
  const bool has_qform = fields.qform_code > 0;
  if (!has_sform) check_sizes(path, fields);
  const Map map = has_sform ? fields.srow : has_qform ? map_of_qform(fields) : map_of_sizes(fields);
  const char* const form = has_sform ? "sform" : has_qform ? "qform" : "pixdim";
  if (!is_finite(map)) {
    throw IoError(path, form, "holds a number that is not finite; correct the header");
  }
  if (!has_sform && has_qform) check_quaternion(path, fields);
  Grid grid;
  grid.dims = {fields.dim[1], fields.dim[2], fields.dim[3]};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double x = map[0][axis], y = map[1][axis], z = map[2][axis];
    grid.spacing[axis] = std::sqrt(x * x + y * y + z * z);
    grid.origin[axis] = map[axis][3];
    for (std::size_t row = 0; row < 3; ++row) {
      grid.direction[3 * row + axis] = map[row][axis] / grid.spacing[axis];
    }
  }
  try {
    check_grid(grid, "grid");
  } catch (const std::invalid_argument& error) {
    throw IoError(path, form, std::string(error.what()) + "; correct the header");
  }
  return grid;
}

bool forms_agree(const NiftiFields& fields, const Grid& grid) {
  const Map qform = map_of_qform(fields);
  const double tolerance = 0.01 * *std::ranges::min_element(grid.spacing);
  for (int corner = 0; corner < 8; ++corner) {
    double index[4] = {0, 0, 0, 1};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if ((corner >> axis & 1) != 0) index[axis] = static_cast<double>(grid.dims[axis] - 1);
    }
    for (std::size_t row = 0; row < 3; ++row) {
      double difference = 0;
      for (std::size_t axis = 0; axis < 4; ++axis) {
        difference += (fields.srow[row][axis] - qform[row][axis]) * index[axis];
      }
      if (!(std::abs(difference) <= tolerance)) return false;
    }
  }
  return true;
}

void set_grid(NiftiFields& fields, const Grid& grid, const NiftiFacts& facts) {
  fields.pixdim[0] = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    fields.dim[axis + 1] = grid.dims[axis];
    fields.pixdim[axis + 1] = grid.spacing[axis];
  }
  const bool has_qform = facts.qform_code > 0 && is_orthonormal(grid);
  int sform_code = facts.sform_code;
  if (sform_code == 0 && !has_qform && !is_plain(grid)) {
    sform_code = std::max<int>(facts.qform_code, NIFTI_XFORM_SCANNER_ANAT);
  }
  if (sform_code > 0) {
    fields.sform_code = sform_code;
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        fields.srow[row][axis] = grid.direction[3 * row + axis] * grid.spacing[axis];
      }
      fields.srow[row][3] = grid.origin[row];
    }
  }
  if (!has_qform) return;
  fields.qform_code = facts.qform_code;
  set_quaternion(fields, grid.direction);
  fields.qoffset = grid.origin;
}

}  // namespace tetwarp
