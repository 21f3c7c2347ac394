/// @file rigid_mass.cpp
/// Sums signed tetrahedra between the triangles and a point.
#include "host/reference/simulate/rigid_mass.hpp"

namespace tetwarp::reference {

// The surface bounds the signed sum of the tetrahedra (o, a, b, c) over its triangles. Integrals
// over one of them, of volume det(a, b, c)/6: of x, V (a+b+c)/4; of x x^T,
// V/20 (a a^T + b b^T + c c^T + (a+b+c)(a+b+c)^T).
RigidBody rigid_of(const Body& body, const Surface& surface) {
  Vector3d origin = Vector3d::Zero();
  for (const Point3& p : surface.points) origin += vector_of(p);
  origin /= static_cast<double>(surface.points.size());
  double volume = 0;
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  for (const auto& triangle : surface.triangles) {
    Matrix3d corners;
    for (int c = 0; c < 3; ++c) {
      const auto point = static_cast<std::size_t>(triangle[static_cast<std::size_t>(c)]);
      corners.col(c) = vector_of(surface.points[point]) - origin;
    }
    const double part = corners.determinant() / 6;
    const Vector3d sum = corners.rowwise().sum();
    volume += part;
    first += part / 4 * sum;
    second += part / 20 * (corners * corners.transpose() + sum * sum.transpose());
  }
  const Vector3d center = first / volume;
  const Matrix3d about_center = second - volume * center * center.transpose();

  RigidBody rigid;
  rigid.center = origin + center;
  rigid.alpha = body.damping.alpha;
  if (body.rigid.mass) {
    const auto& i = *body.rigid.inertia;
    rigid.mass = *body.rigid.mass;
    rigid.inertia << i[0], i[3], i[5], i[3], i[1], i[4], i[5], i[4], i[2];
  } else {
    rigid.mass = body.rigid.density * volume;
    rigid.inertia =
        body.rigid.density * (about_center.trace() * Matrix3d::Identity() - about_center);
  }
  return rigid;
}

}  // namespace tetwarp::reference
