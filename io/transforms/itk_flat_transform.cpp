/// @file itk_flat_transform.cpp
/// Parameters of two dimensions as those of three.
#include "io/transforms/itk_flat_transform.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <tetwarp/error.hpp>
#include <utility>
#include <vector>

namespace tetwarp {
namespace {
using Reals = std::vector<double>;
using Matrix2 = std::array<double, 4>;  // row major

constexpr std::size_t none = 99;

/// Where a type keeps what it is made of; `none`: it has no such parameter.
struct FlatKind {
  const char* name;
  std::size_t parameter_count;
  std::size_t matrix = none;  ///< four entries, or with `is_diagonal` two
  std::size_t angle = none;
  std::size_t scale = none;
  std::size_t translation = none;
  bool is_diagonal = false;
};

constexpr FlatKind flat_kinds[] = {
    {.name = "AffineTransform", .parameter_count = 6, .matrix = 0, .translation = 4},
    {.name = "MatrixOffsetTransformBase", .parameter_count = 6, .matrix = 0, .translation = 4},
    {.name = "TranslationTransform", .parameter_count = 2, .translation = 0},
    {.name = "IdentityTransform", .parameter_count = 0},
    {.name = "Euler2DTransform", .parameter_count = 3, .angle = 0, .translation = 1},
    {.name = "Rigid2DTransform", .parameter_count = 3, .angle = 0, .translation = 1},
    {.name = "Similarity2DTransform",
     .parameter_count = 4,
     .angle = 1,
     .scale = 0,
     .translation = 2},
    {.name = "ScaleTransform", .parameter_count = 2, .matrix = 0, .is_diagonal = true}};

Matrix2 matrix_of(const FlatKind& kind, const Reals& p) {
  if (kind.matrix != none && kind.is_diagonal) return {p[kind.matrix], 0, 0, p[kind.matrix + 1]};
  if (kind.matrix != none) return {p[0], p[1], p[2], p[3]};
  if (kind.angle == none) return {1, 0, 0, 1};
  const double scale = kind.scale == none ? 1 : p[kind.scale];
  const double c = scale * std::cos(p[kind.angle]), s = scale * std::sin(p[kind.angle]);
  return {c, -s, s, c};
}

/// The same type of three dimensions, with the same numbers.
ItkTransform renamed(const ItkTransform& transform) {
  ItkTransform result = transform;
  result.type.replace(result.type.size() - 3, 3, "3_3");
  return result;
}

ItkTransform lifted_affine(const std::string& path,
                           const ItkTransform& transform,
                           const FlatKind& kind) {
  const Reals& p = transform.parameters;
  check_itk_count(path, transform.type, p.size(), kind.parameter_count, "parameters");
  const Matrix2 m = matrix_of(kind, p);
  const bool moves = kind.translation != none;
  ItkTransform affine;
  affine.type = "AffineTransform_double_3_3";
  affine.parameters = {m[0], m[1], 0, m[2], m[3], 0, 0, 0, 1};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    affine.parameters.push_back(moves ? p[kind.translation + axis] : 0);
  }
  affine.parameters.push_back(0);
  const Reals& center = transform.fixed;
  if (moves && kind.matrix == none && kind.angle == none) return affine;  // has no center
  if (center.empty()) return affine;
  check_itk_count(path, transform.type, center.size(), 2, "fixed parameters (center)");
  affine.fixed = {center[0], center[1], 0};
  return affine;
}

/// Fixed parameters of a grid: sizes, origin, spacing, direction.
/// @param sizes, origin  along the third axis
Reals lifted_grid(const std::string& path,
                  const ItkTransform& transform,
                  double sizes,
                  double origin) {
  const Reals& f = transform.fixed;
  check_itk_count(path, transform.type, f.size(), 10,
                  "fixed parameters (size, origin, spacing, direction)");
  return {f[0], f[1], sizes, f[2], f[3], origin, f[4], f[5], flat_thickness,
          f[6], f[7], 0,     f[8], f[9], 0,      0,    0,    1};
}

/// Displacements of two components with 0 as the third one.
Reals with_third(const Reals& numbers) {
  Reals all;
  all.reserve(numbers.size() / 2 * 3);
  for (std::size_t n = 0; n + 1 < numbers.size(); n += 2) {
    all.insert(all.end(), {numbers[n], numbers[n + 1], 0});
  }
  return all;
}

/// @param count  of the parameters
void check_even(const std::string& path, const ItkTransform& transform, std::size_t count) {
  check_itk_count(path, transform.type, count % 2, 0, "parameters beside pairs of them");
}

ItkTransform lifted_field(const std::string& path, const ItkTransform& transform) {
  check_even(path, transform, transform.parameters.size());
  check_even(path, transform, static_cast<std::size_t>(transform.stored));
  ItkTransform field = renamed(transform);
  field.fixed = lifted_grid(path, transform, 1, 0);
  field.parameters = with_third(transform.parameters);
  field.stored = transform.stored / 2 * 3;
  if (!transform.read) return field;
  field.chunk_bytes *= 2;  // numbers as they are stored, and with the third component
  field.read = [read = transform.read](std::int64_t first, std::int64_t count) {
    return with_third(read(first / 3 * 2, count / 3 * 2));
  };
  return field;
}

/// A spline is the same in all planes where its coefficients are.
ItkTransform lifted_spline(const std::string& path, const ItkTransform& transform) {
  constexpr std::size_t planes = 4;  // of which the middle of the inner two is at 0
  check_even(path, transform, transform.parameters.size());
  ItkTransform spline = renamed(transform);
  spline.fixed = lifted_grid(path, transform, planes, -1.5 * flat_thickness);
  const auto count = static_cast<std::ptrdiff_t>(transform.parameters.size() / 2);
  spline.parameters.clear();
  for (std::ptrdiff_t axis = 0; axis < 2; ++axis) {
    const auto begin = transform.parameters.begin() + axis * count;
    for (std::size_t plane = 0; plane < planes; ++plane) {
      spline.parameters.insert(spline.parameters.end(), begin, begin + count);
    }
  }
  spline.parameters.resize(spline.parameters.size() / 2 * 3, 0.0);
  return spline;
}
}  // namespace

bool is_flat(const ItkTransform& transform) {
  return transform.type.ends_with("_2_2");
}

ItkTransform lifted(const std::string& path, const ItkTransform& transform) {
  const std::string name = itk_class(transform.type);
  if (is_itk_field(transform.type)) return lifted_field(path, transform);
  if (name.ends_with("BSplineTransform")) return lifted_spline(path, transform);
  const FlatKind* const kind =
      std::find_if(std::begin(flat_kinds), std::end(flat_kinds),
                   [&](const FlatKind& known) { return name == known.name; });
  return kind == std::end(flat_kinds) ? transform : lifted_affine(path, transform, *kind);
}

}  // namespace tetwarp
