/// @file itk_transform.cpp
/// Parses files, and computes matrices from parameters as ITK's classes do.
#include "io/transforms/itk_transform.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <tetwarp/error.hpp>

#include "io/files/text_file.hpp"

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

/// y = M (x - c) + c + t, in LPS.
AffineTransform affine_of(const std::string& path, const ItkTransform& transform) {
  const std::string name = transform.type.substr(0, transform.type.find('_'));
  const Kind* const kind = std::find_if(std::begin(kinds), std::end(kinds),
                                        [&](const Kind& known) { return name == known.name; });
  if (kind == std::end(kinds) || !transform.type.ends_with("_3_3")) {
    throw IoError(path, transform.type,
                  "is no affine transform of three dimensions; read are " + listed_kinds() +
                      ". Convert others to a displacement field, for example by SimpleITK's "
                      "TransformToDisplacementField");
  }
  const std::vector<double>& p = transform.parameters;
  const bool is_finite = std::all_of(p.begin(), p.end(), [](double x) { return std::isfinite(x); });
  if (p.size() != kind->parameter_count || !is_finite) {
    throw IoError(path, transform.type,
                  "expected " + std::to_string(kind->parameter_count) + " finite parameters");
  }
  AffineTransform affine{kind->matrix(transform), {0, 0, 0}};
  Point3 center{0, 0, 0};
  if (transform.fixed.size() >= 3) std::copy_n(transform.fixed.begin(), 3, center.begin());
  const Point3 turned = product(affine.matrix, center);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    affine.offset[axis] = center[axis] - turned[axis];
    if (kind->translation != no_translation) affine.offset[axis] += p[kind->translation + axis];
  }
  return affine;
}

std::vector<double> numbers_in(const std::string& path, const std::string& text) {
  std::vector<double> numbers;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    double number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size()) {
      throw IoError(path, "", "'" + word + "' is no number");
    }
    numbers.push_back(number);
  }
  return numbers;
}
}  // namespace

std::vector<ItkTransform> read_itk_text(const std::string& path) {
  const std::string text = read_text(path);
  if (!text.starts_with("#Insight Transform File")) {
    throw IoError(path, "",
                  "is no transform file of ITK, which begins with '#Insight Transform File'; a "
                  "matrix alone does not tell its axes and direction");
  }
  std::vector<ItkTransform> transforms;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t colon = line.find(':');
    if (line.empty() || line[0] == '#' || colon == std::string::npos) continue;
    const std::string key = line.substr(0, colon), value = line.substr(colon + 1);
    if (key == "Transform") {
      const std::size_t begin = value.find_first_not_of(' ');
      const std::size_t end = value.find_last_not_of(" \r") + 1;
      if (begin == std::string::npos) throw IoError(path, "", "names no type of a transform");
      transforms.push_back({value.substr(begin, end - begin), {}, {}});
    } else if (!transforms.empty() && key == "Parameters") {
      transforms.back().parameters = numbers_in(path, value);
    } else if (!transforms.empty() && key == "FixedParameters") {
      transforms.back().fixed = numbers_in(path, value);
    }
  }
  return transforms;
}

/// Level 4 files: for each matrix a head of five numbers, a name, and its entries.
std::vector<ItkTransform> read_itk_matlab(const std::string& path) {
  const std::string bytes = read_text(path);
  std::vector<ItkTransform> transforms;
  const auto damaged = [&] {
    return IoError(path, "",
                   "is no MATLAB file (level 4) that ITK or ANTs wrote; a matrix alone does not "
                   "tell its axes and direction");
  };
  for (std::size_t at = 0; at < bytes.size();) {
    std::array<std::int32_t, 5> head;  // type, rows, columns, imaginary, bytes of the name
    if (bytes.size() - at < sizeof head) throw damaged();
    std::memcpy(head.data(), bytes.data() + at, sizeof head);
    at += sizeof head;
    const bool is_single = head[0] % 100 == 10;
    const bool is_sound = (head[0] % 100 == 0 || is_single) && head[0] >= 0 && head[0] < 200 &&
                          head[1] >= 0 && head[2] >= 0 && head[1] < 1000 && head[2] < 1000 &&
                          head[3] == 0 && head[4] > 0 && head[4] < 256;
    const std::size_t count = is_sound ? static_cast<std::size_t>(head[1] * head[2]) : 0;
    const std::size_t size = is_single ? 4 : 8, name_size = static_cast<std::size_t>(head[4]);
    if (!is_sound || bytes.size() - at < name_size + count * size) throw damaged();
    const std::string name(bytes.data() + at, strnlen(bytes.data() + at, name_size));
    at += name_size;
    std::vector<double> numbers(count);
    for (double& number : numbers) {
      float narrow = 0;
      std::memcpy(is_single ? static_cast<void*>(&narrow) : &number, bytes.data() + at, size);
      if (is_single) number = static_cast<double>(narrow);
      at += size;
    }
    if (name != "fixed") {
      transforms.push_back({name, numbers, {}});
    } else if (!transforms.empty()) {
      transforms.back().fixed = numbers;
    }
  }
  return transforms;
}

AffineTransform affine_of(const std::string& path, const std::vector<ItkTransform>& transforms) {
  if (transforms.empty()) throw IoError(path, "", "holds no transform");
  const bool is_composite = transforms.front().type.starts_with("CompositeTransform");
  if (!is_composite && transforms.size() > 1) {
    throw IoError(path, "",
                  "holds " + std::to_string(transforms.size()) +
                      " transforms and not how they follow each other; write a composite");
  }
  AffineTransform all;
  for (std::size_t t = is_composite ? 1 : 0; t < transforms.size(); ++t) {
    const AffineTransform one = affine_of(path, transforms[t]);  // applied before those so far
    const Point3 moved = product(all.matrix, one.offset);
    for (std::size_t axis = 0; axis < 3; ++axis) all.offset[axis] += moved[axis];
    all.matrix = product(all.matrix, one.matrix);
  }
  for (const std::size_t mixed : {2, 5, 6, 7}) all.matrix[mixed] = 0 - all.matrix[mixed];
  for (const std::size_t axis : {0, 1}) all.offset[axis] = 0 - all.offset[axis];
  return all;
}

}  // namespace tetwarp
