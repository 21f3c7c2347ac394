/// @file rigid_scene.hpp
/// Builds the contact problem of rigid bodies.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/base/point3.hpp"
#include "tests/support/contact/contact_scenes.hpp"

namespace tetwarp::scenes {

/// Rigid bodies and contacts between them, one after the other.
class RigidScene {
 public:
  void add_body(double mass, double inertia, const Point3& impulse) {
    const auto first = static_cast<std::int64_t>(problem_.load.size());
    for (std::int64_t a = 0; a < 6; ++a) {
      mass_.push_back({first + a, first + a, a < 3 ? mass : inertia});
      problem_.load.push_back(a < 3 ? impulse[static_cast<std::size_t>(a)] : 0.0);
    }
  }
  /// Contact of body a (arm from its center) with body b, or with the world: b = -1.
  void add_contact(std::int64_t a,
                   const Point3& arm_a,
                   std::int64_t b,
                   const Point3& arm_b,
                   const Point3& normal,
                   double gap_speed,
                   double friction) {
    const Point3 helper = std::abs(normal[0]) < 0.8 ? Point3{1, 0, 0} : Point3{0, 1, 0};
    Point3 tangent = cross(normal, helper);
    const double length =
        std::sqrt(tangent[0] * tangent[0] + tangent[1] * tangent[1] + tangent[2] * tangent[2]);
    for (double& x : tangent) x /= length;
    for (const Point3& axis : {normal, tangent, cross(normal, tangent)}) {
      add_row(a, axis, arm_a, 1);
      if (b >= 0) add_row(b, axis, arm_b, -1);
      ++row_;
    }
    problem_.velocity_offset.insert(problem_.velocity_offset.end(), {gap_speed, 0, 0});
    problem_.friction.push_back(friction);
  }
  ContactProblem take() {
    const auto dofs = static_cast<std::int64_t>(problem_.load.size());
    problem_.system = sparse_matrix(dofs, dofs, std::move(mass_));
    problem_.jacobian = sparse_matrix(row_, dofs, std::move(jacobian_));
    for (std::int64_t d = 0; d <= dofs; d += 6) {
      problem_.block_start.push_back(static_cast<std::int32_t>(d));
    }
    return std::move(problem_);
  }

 private:
  void add_row(std::int64_t body, const Point3& axis, const Point3& arm, double sign) {
    const Point3 turn = cross(arm, axis);
    for (std::size_t a = 0; a < 3; ++a) {
      const std::int64_t dof = 6 * body + static_cast<std::int64_t>(a);
      jacobian_.push_back({row_, dof, sign * axis[a]});
      jacobian_.push_back({row_, dof + 3, sign * turn[a]});
    }
  }

  ContactProblem problem_;
  std::vector<Entry> mass_, jacobian_;
  std::int64_t row_ = 0;
};

}  // namespace tetwarp::scenes
