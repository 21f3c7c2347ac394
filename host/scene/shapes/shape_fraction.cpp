/// @file shape_fraction.cpp
/// Divides tetrahedra that the surface may cross, and sums the parts inside.
#include "host/scene/shapes/shape_fraction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include "host/scene/shapes/shape.hpp"

namespace tetwarp {
namespace {
using Corners = std::array<Point3, 4>;

/// Share of a tetrahedron in which the linear function of its corners' levels is negative.
double linear_fraction(std::array<double, 4> level) {
  std::sort(level.begin(), level.end());
  const auto [a, b, c, d] = level;
  if (a >= 0) return 0;
  if (d <= 0) return 1;
  if (b >= 0) return a / (a - b) * (a / (a - c)) * (a / (a - d));
  if (c <= 0) return 1 - d / (d - a) * (d / (d - b)) * (d / (d - c));
  // A prism between the cuts of the edges a-c, a-d, b-c, b-d, as three tetrahedra.
  const double ac = a / (a - c), ad = a / (a - d), bc = b / (b - c), bd = b / (b - d);
  return ac * ad * (1 - bd) + ac * (1 - bc) * bd + bc * bd;
}

double longest_edge(const Corners& x) {
  double longest = 0;
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = a + 1; b < 4; ++b) longest = std::max(longest, norm(minus(x[a], x[b])));
  }
  return longest;
}

Point3 middle(const Point3& a, const Point3& b) {
  return times(0.5, plus(a, b));
}

/// Eight parts of equal volume: four corners, and the octahedron between them cut along its
/// shortest diagonal.
std::array<Corners, 8> divided(const Corners& x) {
  const Point3 ab = middle(x[0], x[1]), ac = middle(x[0], x[2]), ad = middle(x[0], x[3]);
  const Point3 bc = middle(x[1], x[2]), bd = middle(x[1], x[3]), cd = middle(x[2], x[3]);
  // The diagonals, each with the cycle of the other four middles around it.
  struct Cut {
    Point3 from, to;
    std::array<Point3, 4> around;
  };
  const std::array<Cut, 3> cuts{Cut{ab, cd, {ac, ad, bd, bc}}, Cut{ac, bd, {ab, ad, cd, bc}},
                                Cut{ad, bc, {ab, ac, cd, bd}}};
  const Cut& cut = *std::min_element(cuts.begin(), cuts.end(), [](const Cut& a, const Cut& b) {
    const Point3 x = minus(a.to, a.from), y = minus(b.to, b.from);
    return dot(x, x) < dot(y, y);
  });
  std::array<Corners, 8> parts{Corners{x[0], ab, ac, ad}, Corners{x[1], ab, bc, bd},
                               Corners{x[2], ac, bc, cd}, Corners{x[3], ad, bd, cd}};
  for (std::size_t n = 0; n < 4; ++n) {
    parts[4 + n] = {cut.from, cut.to, cut.around[n], cut.around[(n + 1) % 4]};
  }
  return parts;
}

class Divider {
 public:
  explicit Divider(const Shape& shape) : level_(make_level(shape)), slope_(level_slope(shape)) {}

  /// @param divisions  of the tetrahedron that remain
  double fraction(const Corners& x, int divisions) const {
    const Point3 center = times(0.25, plus(plus(x[0], x[1]), plus(x[2], x[3])));
    double reach = 0;
    for (const Point3& corner : x) {
      const Point3 from_center = minus(corner, center);
      reach = std::max(reach, dot(from_center, from_center));
    }
    reach = std::sqrt(reach);
    const double level = level_(center);
    if (level >= slope_ * reach) return 0;
    if (level <= -slope_ * reach) return 1;
    if (divisions <= 0) {
      std::array<double, 4> corner{level_(x[0]), level_(x[1]), level_(x[2]), level_(x[3])};
      // Linear interpolation of a quadratic function is off by 4/5 of its error at the center on
      // average over a tetrahedron.
      const double mean = 0.25 * (corner[0] + corner[1] + corner[2] + corner[3]);
      for (double& value : corner) value -= 0.8 * (mean - level);
      return linear_fraction(corner);
    }
    double sum = 0;
    for (const Corners& part : divided(x)) sum += fraction(part, divisions - 1);
    return sum / 8;
  }

 private:
  std::function<double(const Point3&)> level_;
  double slope_;
};
}  // namespace

std::vector<double> fractions_inside(const Shape& shape, const TetMesh& mesh, double resolution) {
  const Divider divider(shape);
  std::vector<double> fraction;
  fraction.reserve(mesh.tets.size());
  for (const auto& [a, b, c, d] : mesh.tets) {
    const Corners x{at(mesh.nodes, a), at(mesh.nodes, b), at(mesh.nodes, c), at(mesh.nodes, d)};
    const double divisions = std::ceil(std::log2(longest_edge(x) / resolution));
    fraction.push_back(divider.fraction(x, static_cast<int>(std::min(divisions, 12.0))));
  }
  return fraction;
}

}  // namespace tetwarp
