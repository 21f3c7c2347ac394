/// @file rigid.cpp
/// Mass properties of closed surfaces, principal axes, and states at the start.
#include "host/simulate/model/rigid.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "host/simulate/model/body_part.hpp"
#include "host/simulate/model/rotations.hpp"
#include "kernels/base/symmetric_eigen.hpp"

namespace tetwarp {

RigidProperties properties_of(const Surface& surface, double density) {
  Point3 origin{0, 0, 0};
  const double share = 1.0 / static_cast<double>(surface.points.size());
  for (const Point3& point : surface.points) origin = plus(origin, times(share, point));
  // Signed tetrahedra (origin, a, b, c) of volume V: the integral of x is V s / 4 and that of x x^T
  // is V/20 (a a^T + b b^T + c c^T + s s^T), where s = a + b + c.
  double volume = 0;
  Point3 first{0, 0, 0};
  std::array<double, 9> second{};
  const auto add_square = [&](double factor, const Point3& x) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) second[3 * i + j] += factor * x[i] * x[j];
    }
  };
  for (const auto& triangle : surface.triangles) {
    std::array<Point3, 3> x;
    for (std::size_t c = 0; c < 3; ++c) x[c] = minus(at(surface.points, triangle[c]), origin);
    const double part = dot(x[0], cross(x[1], x[2])) / 6;
    const Point3 sum = plus(x[0], plus(x[1], x[2]));
    volume += part;
    first = plus(first, times(part / 4, sum));
    for (const Point3& corner : {x[0], x[1], x[2], sum}) add_square(part / 20, corner);
  }
  RigidProperties result;
  result.mass = density * volume;
  const Point3 center = times(1 / volume, first);
  result.center = plus(origin, center);
  add_square(-volume, center);
  const double trace = second[0] + second[4] + second[8];
  for (std::size_t i = 0; i < 9; ++i) {
    result.inertia[i] = density * ((i % 4 == 0 ? trace : 0) - second[i]);
  }
  return result;
}

namespace {

struct PrincipalAxes {
  Point3 moment{};
  Quaternion axes{1, 0, 0, 0};
};

PrincipalAxes principal_axes_of(const std::array<double, 9>& inertia) {
  double matrix[3][3], vectors[3][3];
  for (std::size_t i = 0; i < 9; ++i) matrix[i / 3][i % 3] = inertia[i];
  symmetric_eigen<3>(matrix, vectors);
  PrincipalAxes result;
  std::array<Point3, 3> columns;
  for (std::size_t k = 0; k < 3; ++k) {
    result.moment[k] = matrix[k][k];
    for (std::size_t d = 0; d < 3; ++d) columns[k][d] = vectors[d][k];
  }
  if (dot(columns[2], cross(columns[0], columns[1])) < 0) columns[2] = times(-1, columns[2]);
  result.axes = quaternion_of(columns);
  return result;
}

}  // namespace

void add_rigid(const BodyPart& part, Model& model) {
  const Body& body = part.body;
  const auto fail = [&](const std::string& what) {
    throw std::invalid_argument(error_prefix(part) + what);
  };
  if (part.geometry.surface.triangles.empty()) fail("a rigid body needs a closed surface");
  RigidProperties properties = properties_of(part.geometry.surface, 1);
  if (!(properties.mass > 0) || !std::isfinite(properties.mass)) {
    fail(
        "its surface encloses no volume; give a closed surface whose triangles are "
        "counter-clockwise from outside");
  }
  if (body.rigid.mass) {
    const auto [xx, yy, zz, xy, yz, xz] = *body.rigid.inertia;
    properties.mass = *body.rigid.mass;
    properties.inertia = {xx, xy, xz, xy, yy, yz, xz, yz, zz};
  } else {
    properties.mass *= body.rigid.density;
    for (double& entry : properties.inertia) entry *= body.rigid.density;
  }
  const PrincipalAxes principal = principal_axes_of(properties.inertia);
  const auto& moment = principal.moment;
  if (!(std::min({moment[0], moment[1], moment[2]}) > 0) || !is_finite(moment)) {
    fail(body.rigid.mass ? "inertia: not all principal moments are above 0; correct it"
                         : "its surface is too thin: not all principal moments of inertia are "
                           "above 0 in float64; give a thicker one, or mass and inertia");
  }

  model.rigid.body.push_back(part.index);
  model.rigid.mass.push_back(properties.mass);
  model.rigid.inertia.push_back(moment);
  model.rigid.alpha.push_back(body.damping.alpha);
  model.rigid.center.push_back(properties.center);
  model.rigid.axes.push_back(principal.axes);
  const Quaternion rotation = product(normalized(body.pose.rotation), principal.axes);
  Point3 momentum = rotate(conjugate(rotation), body.angular_velocity);
  for (std::size_t d = 0; d < 3; ++d) momentum[d] *= moment[d];
  model.start.position.push_back(world_of(body.pose, properties.center));
  model.start.rotation.push_back(rotation);
  model.start.angular_momentum.push_back(rotate(rotation, momentum));
  model.start.velocity.push_back(body.velocity);
  model.start.velocity.push_back(body.angular_velocity);
  model.prescribed.insert(model.prescribed.end(), 2, std::uint8_t{0});
  ++model.rigid_count;
}

std::int32_t add_frame(std::int32_t body, const Pose& pose, Model& model) {
  model.rigid.body.push_back(body);
  model.rigid.mass.push_back(0);
  model.rigid.inertia.push_back({0, 0, 0});
  model.rigid.alpha.push_back(0);
  model.rigid.center.push_back({0, 0, 0});
  model.rigid.axes.push_back({1, 0, 0, 0});
  model.start.position.push_back(pose.position);
  model.start.rotation.push_back(normalized(pose.rotation));
  model.start.angular_momentum.push_back({0, 0, 0});
  model.start.velocity.insert(model.start.velocity.end(), 2, Point3{0, 0, 0});
  model.prescribed.insert(model.prescribed.end(), 2, std::uint8_t{1});
  return model.rigid_count++;
}

}  // namespace tetwarp
