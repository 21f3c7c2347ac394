/// @file itk_transform.cpp
/// Computes matrices, fields and splines from parameters as ITK's classes do.
#include "io/transforms/itk_transform.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <memory>
#include <set>
#include <stdexcept>
#include <tetwarp/error.hpp>
#include <tetwarp/itk_space.hpp>
#include <utility>

#include "io/transforms/itk_flat_transform.hpp"

namespace tetwarp {
namespace {
using Matrix = std::array<double, 9>;  // row major

constexpr Matrix unit{1, 0, 0, 0, 1, 0, 0, 0, 1};

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      for (std::size_t n = 0; n < 3; ++n) c[3 * row + column] += a[3 * row + n] * b[3 * n + column];
    }
  }
  return c;
}

Point3 product(const Matrix& a, const Point3& x) {
  Point3 y{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t n = 0; n < 3; ++n) y[row] += a[3 * row + n] * x[n];
  }
  return y;
}

/// Rotation about an axis.
Matrix rotation(std::size_t axis, double angle) {
  const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
  Matrix matrix = unit;
  matrix[3 * a + a] = matrix[3 * b + b] = std::cos(angle);
  matrix[3 * b + a] = std::sin(angle);
  matrix[3 * a + b] = -matrix[3 * b + a];
  return matrix;
}

/// Rotation of a unit quaternion, of which the vector is given.
Matrix versor_rotation(const double* v) {
  const double x = v[0], y = v[1], z = v[2];
  const double w = std::sqrt(std::max(0.0, 1 - x * x - y * y - z * z));
  return {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
          2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
          2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
}

Matrix scaled(Matrix matrix, double factor) {
  for (double& entry : matrix) entry *= factor;
  return matrix;
}

constexpr std::size_t no_translation = 99;

/// A type of transform: number of parameters, its matrix, and where its translation begins.
struct Kind {
  const char* name;
  std::size_t parameter_count;
  Matrix (*matrix)(const ItkTransform& transform);
  std::size_t translation;
};

Matrix matrix_of_parameters(const ItkTransform& transform) {
  Matrix matrix;
  std::copy_n(transform.parameters.begin(), 9, matrix.begin());
  return matrix;
}

Matrix euler_matrix(const ItkTransform& transform) {
  const std::vector<double>& p = transform.parameters;
  const Matrix x = rotation(0, p[0]), y = rotation(1, p[1]), z = rotation(2, p[2]);
  const bool is_zyx = transform.fixed.size() > 3 && transform.fixed[3] != 0;
  return is_zyx ? product(z, product(y, x)) : product(z, product(x, y));
}

constexpr Kind kinds[] = {
    {"AffineTransform", 12, matrix_of_parameters, 9},
    {"MatrixOffsetTransformBase", 12, matrix_of_parameters, 9},
    {"TranslationTransform", 3, [](const ItkTransform&) { return unit; }, 0},
    {"IdentityTransform", 0, [](const ItkTransform&) { return unit; }, no_translation},
    {"Euler3DTransform", 6, euler_matrix, 3},
    {"VersorRigid3DTransform", 6,
     [](const ItkTransform& t) { return versor_rotation(t.parameters.data()); }, 3},
    {"VersorTransform", 3,
     [](const ItkTransform& t) { return versor_rotation(t.parameters.data()); }, no_translation},
    {"Similarity3DTransform", 7,
     [](const ItkTransform& t) {
       return scaled(versor_rotation(t.parameters.data()), t.parameters[6]);
     },
     3},
    {"ScaleTransform", 3,
     [](const ItkTransform& t) {
       return Matrix{t.parameters[0], 0, 0, 0, t.parameters[1], 0, 0, 0, t.parameters[2]};
     },
     no_translation}};

std::string listed_kinds() {
  std::string text;
  for (const Kind& kind : kinds) text += (text.empty() ? "" : ", ") + std::string(kind.name);
  return text;
}

/// Throws about a type that is not read.
[[noreturn]] void refuse(const std::string& path, const std::string& type) {
  throw IoError(path, type,
                "is no transform that is read; of three dimensions these are " + listed_kinds() +
                    ", DisplacementFieldTransform, cubic BSplineTransform and composites of them, "
                    "of two Euler2DTransform, Similarity2DTransform and those without 3D. Convert "
                    "others to a displacement field, for example by SimpleITK's "
                    "TransformToDisplacementField");
}

/// Between positions that are multiplied by a factor, as scaled() multiplies those of a grid.
AffineTransform scaled(AffineTransform affine, const Point3& factor) {
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t n = 0; n < 3; ++n) {
      double& entry = affine.matrix[3 * row + n];
      entry = 0 + factor[row] / factor[n] * entry;  // no -0
    }
    affine.offset[row] = 0 + factor[row] * affine.offset[row];
  }
  return affine;
}

/// y = M (x - c) + c + t.
AffineTransform affine_of(const std::string& path,
                          const ItkTransform& transform,
                          const Kind& kind) {
  const std::vector<double>& p = transform.parameters;
  check_itk_count(path, transform.type, p.size(), kind.parameter_count, "parameters");
  AffineTransform affine{kind.matrix(transform), {0, 0, 0}};
  Point3 center{0, 0, 0};
  if (!transform.fixed.empty() && transform.fixed.size() < 3) {
    check_itk_count(path, transform.type, transform.fixed.size(), 3, "fixed parameters");
  }
  if (!transform.fixed.empty()) std::copy_n(transform.fixed.begin(), 3, center.begin());
  const Point3 turned = product(affine.matrix, center);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    affine.offset[axis] = center[axis] - turned[axis];
    if (kind.translation != no_translation) affine.offset[axis] += p[kind.translation + axis];
  }
  return affine;
}

/// The grid of fixed parameters: sizes, origin, spacing, direction by rows.
Grid grid_of(const std::string& path, const ItkTransform& transform) {
  const std::vector<double>& f = transform.fixed;
  check_itk_count(path, transform.type, f.size(), 18,
                  "fixed parameters (size, origin, spacing, direction)");
  Grid grid;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(f[axis] >= 1 && f[axis] <= 0x1p30) || f[axis] != std::floor(f[axis])) {
      throw IoError(path, transform.type,
                    "has a size of " + std::to_string(f[axis]) + ", expected 1 to 2^30");
    }
    grid.dims[axis] = static_cast<std::int64_t>(f[axis]);
    grid.origin[axis] = f[3 + axis];
    grid.spacing[axis] = f[6 + axis];
    for (std::size_t n = 0; n < 3; ++n) grid.direction[3 * axis + n] = f[9 + 3 * axis + n];
  }
  try {
    check_grid(grid, "its grid");
  } catch (const std::invalid_argument& error) {
    throw IoError(path, transform.type, error.what());
  }
  const auto expected = 3 * static_cast<std::size_t>(grid.voxel_count());
  check_itk_count(
      path, transform.type,
      transform.read ? static_cast<std::size_t>(transform.stored) : transform.parameters.size(),
      expected, "parameters, three per grid point");
  return grid;
}

/// Reads displacements from parameters, as many rows at a time as follow each other in the file.
class ItkField {
 public:
  /// @param factor  of the numbers, component by component
  ItkField(const Grid& grid, ItkTransform transform, const Point3& factor)
      : grid_(grid), transform_(std::move(transform)), factor_(factor) {}

  double chunk_bytes() const {
    return transform_.chunk_bytes +
           static_cast<double>(sizeof(double) * std::max(most_numbers, 3 * grid_.dims[0]));
  }

  void read(const Region& region, float* displacement) const {
    const auto& [begin, end] = region;
    const bool are_whole_slices = end[1] - begin[1] == grid_.dims[1];
    const std::int64_t runs = are_whole_slices ? 1 : end[2] - begin[2];
    const std::int64_t rows = (end[1] - begin[1]) * (end[2] - begin[2]) / runs;
    for (std::int64_t run = 0; run < runs; ++run) {
      const std::int64_t first = begin[1] + grid_.dims[1] * (begin[2] + run);
      read_rows(first, first + rows, region, displacement);
    }
  }

 private:
  static constexpr std::int64_t most_numbers = 1 << 19;  // 4 MB, or a row

  /// Reads rows [first, end), numbered through all slices.
  /// @param displacement  moves to the end of what is read
  void read_rows(std::int64_t first,
                 std::int64_t end,
                 const Region& region,
                 float*& displacement) const {
    const std::int64_t width = 3 * grid_.dims[0];
    const std::int64_t at_once = std::max<std::int64_t>(1, most_numbers / width);
    for (std::int64_t row = first; row < end; row += at_once) {
      const std::int64_t count = std::min(at_once, end - row);
      const std::vector<double> read = numbers(width * row, width * count);
      for (std::int64_t r = 0; r < count; ++r) {
        const double* const number = read.data() + width * r;
        for (std::int64_t n = 3 * region.begin[0]; n < 3 * region.end[0]; ++n) {
          const double factor = factor_[static_cast<std::size_t>(n % 3)];
          *displacement++ = static_cast<float>(0 + factor * number[n]);
        }
      }
    }
  }

  std::vector<double> numbers(std::int64_t first, std::int64_t count) const {
    if (!transform_.read) {
      const auto begin = transform_.parameters.begin() + first;
      return {begin, begin + count};
    }
    return transform_.read(first, count);
  }

  Grid grid_;
  ItkTransform transform_;
  Point3 factor_;
};

/// ITK stores all x coefficients, then y, then z.
BSplineTransform spline_of(const std::string& path,
                           const ItkTransform& transform,
                           const Point3& factor) {
  BSplineTransform spline{scaled(grid_of(path, transform), factor), {}};
  if (std::ranges::min(spline.grid.dims) < 4) {
    throw IoError(path, transform.type, "has fewer than 4 coefficients along an axis");
  }
  const std::size_t count = transform.parameters.size() / 3;
  spline.coefficients.resize(transform.parameters.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t n = 0; n < count; ++n) {
      const double number = transform.parameters[axis * count + n];
      spline.coefficients[3 * n + axis] = 0 + factor[axis] * number;
    }
  }
  return spline;
}

/// One transform, with what reads its displacements if it is a field.
struct SingleLink {
  SingleTransform transform;
  FieldReader field;
  bool is_inverted = false;  ///< see TransformFile
};

/// @param factor  of positions and displacements
SingleLink single_of(const std::string& path, const ItkTransform& transform, const Point3& factor) {
  const std::string name = itk_class(transform.type);
  const bool is_inverted = name.starts_with("Inverse");  // a type of 3D Slicer
  if (!transform.type.ends_with("_3_3")) refuse(path, transform.type);
  if (is_itk_field(transform.type)) {
    const Grid grid = grid_of(path, transform);
    const auto field = std::make_shared<const ItkField>(grid, transform, factor);
    const auto read = [field](const Region& region, float* displacement) {
      field->read(region, displacement);
    };
    return {DisplacementField{scaled(grid, factor), {}},
            {.read = read, .chunk_bytes = field->chunk_bytes()},
            is_inverted};
  }
  if (name == "BSplineTransform" || name == "InverseBSplineTransform") {
    return {spline_of(path, transform, factor), {}, is_inverted};
  }
  const Kind* const kind = std::find_if(std::begin(kinds), std::end(kinds),
                                        [&](const Kind& known) { return name == known.name; });
  if (kind == std::end(kinds)) refuse(path, transform.type);
  return {scaled(affine_of(path, transform, *kind), factor), {}};
}

/// Appends a transform that follows; two affine ones become one.
void append(std::vector<SingleLink>& links, SingleLink next) {
  auto* const last =
      links.empty() ? nullptr : std::get_if<AffineTransform>(&links.back().transform);
  const auto* const affine = std::get_if<AffineTransform>(&next.transform);
  if (last == nullptr || affine == nullptr) {
    links.push_back(std::move(next));
    return;
  }
  AffineTransform both{product(affine->matrix, last->matrix),
                       product(affine->matrix, last->offset)};
  for (std::size_t axis = 0; axis < 3; ++axis) both.offset[axis] += affine->offset[axis];
  *last = both;
}
}  // namespace

std::string itk_class(const std::string& type) {
  return type.substr(0, type.find('_'));
}

void check_itk_count(const std::string& path,
                     const std::string& type,
                     std::size_t count,
                     std::size_t expected,
                     const char* what) {
  if (count == expected) return;
  throw IoError(
      path, type,
      "expected " + std::to_string(expected) + " " + what + ", got " + std::to_string(count));
}

bool is_itk_field(const std::string& type) {
  static const std::set<std::string> names{"DisplacementFieldTransform",
                                           "InverseDisplacementFieldTransform",
                                           "GaussianSmoothingOnUpdateDisplacementFieldTransform",
                                           "BSplineSmoothingOnUpdateDisplacementFieldTransform"};
  return names.contains(itk_class(type));
}

TransformParts transform_of(const std::string& path,
                            const std::vector<ItkTransform>& transforms,
                            const Point3& world) {
  if (transforms.empty()) throw IoError(path, "", "holds no transform");
  const bool is_composite = transforms.front().type.starts_with("CompositeTransform");
  if (!is_composite && transforms.size() > 1) {
    throw IoError(path, "",
                  "holds " + std::to_string(transforms.size()) +
                      " transforms and not how they follow each other; write a composite");
  }
  std::vector<SingleLink> links;
  for (std::size_t t = transforms.size(); t > (is_composite ? 1U : 0U); --t) {
    const ItkTransform& next = transforms[t - 1];
    if (is_flat(next) != is_flat(transforms.back())) {
      throw IoError(path, "", "holds transforms of two and of three dimensions");
    }
    append(links,
           single_of(path, is_flat(next) ? lifted(path, next) : next, ratio({-1, -1, 1}, world)));
  }
  if (links.empty()) links.push_back({AffineTransform{}, {}});
  TransformParts parts;
  TransformChain chain;
  for (SingleLink& link : links) {
    parts.fields.push_back(std::move(link.field));
    parts.file.is_inverted.push_back(link.is_inverted);
    chain.links.push_back(std::move(link.transform));
  }
  if (chain.links.size() > 1) {
    parts.file.transform = std::move(chain);
  } else {
    std::visit([&](auto& only) { parts.file.transform = std::move(only); }, chain.links.front());
  }
  return parts;
}

}  // namespace tetwarp
