/// @file rigid_bodies.hpp
/// A small simulation of rigid boxes on planes and on each other, stepped implicitly.
///
/// Each step finds the contacts, sets up A v = J^T r + b with A the masses and inertias, solves it
/// with the contact laws, moves the bodies with these velocities, and updates bonds by the tracker.
/// Boxes touch with points on their z faces: planes with all of them, each other with those of the
/// smaller face on the larger.
#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include <tetwarp/contact.hpp>
#include <tetwarp/contact_tracker.hpp>

namespace tetwarp::test {

/// A point of a surface that stands for a part of it.
struct SurfacePoint {
  Eigen::Vector3d position;  ///< in body coordinates [m]
  double area;               ///< [m^2]
};

/// A box about its center of mass, free to move.
struct RigidBox {
  Eigen::Vector3d half_extents;          ///< [m]
  double mass;                           ///< [kg]
  Eigen::Vector3d inertia;               ///< about the box's axes [kg m^2]
  std::vector<SurfacePoint> points;      ///< on the faces z = -h and z = +h
  BodyPose pose = {};                    ///< of the center
  Eigen::Vector3d velocity = {0, 0, 0};  ///< [m/s]
  Eigen::Vector3d spin = {0, 0, 0};      ///< world axes [rad/s]
  Eigen::Vector3d force = {0, 0, 0};     ///< constant, at the center [N]
};

/// A homogeneous box with `points_per_edge`^2 points on each z face, sharing its area evenly; one
/// point is in the middle.
RigidBox make_box(const Eigen::Vector3d& half_extents, double mass, int points_per_edge = 2);

/// A half-space that never moves; boxes are kept on the side of its normal.
struct Plane {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;  ///< unit
  std::int32_t material = 0;
};

struct WorldOptions {
  double time_step = 1e-3;        ///< [s]
  double margin = 1e-3;           ///< contacts are reported up to this gap [m]
  std::int32_t box_material = 0;  ///< between boxes
  Eigen::Vector3d gravity = {0, 0, -9.81};
  ContactTrackerOptions tracking = {};
  ContactOptions solving = {};
};

class RigidWorld {
 public:
  std::vector<RigidBox> boxes;
  std::vector<Plane> planes;
  ContactTracker tracker;

  explicit RigidWorld(const WorldOptions& options)
      : tracker(options.tracking), options_(options), solver_(options.solving) {}

  /// One step. Returns what the solver found; contacts() are the rows.
  const ContactSolution& step();

  double time() const { return time_; }
  const std::vector<TrackedContact>& contacts() const { return contacts_; }
  const ContactProblem& problem() const { return problem_; }  ///< of the last step
  const ContactSolution& solution() const { return solution_; }

  /// Kinetic energy, potential of gravity and constant forces, and the stretched springs [J].
  double energy() const;
  double kinetic_energy() const;
  double spring_energy() const;

  /// Poses as the tracker numbers bodies: 0 the planes, b + 1 box b.
  std::vector<BodyPose> poses() const;

 private:
  std::vector<ReportedContact> report() const;
  void report_plane(std::size_t plane, std::vector<ReportedContact>& reports) const;
  void report_pair(std::size_t pointed,
                   std::size_t faced,
                   std::vector<ReportedContact>& reports) const;
  void assemble();
  void move(const std::vector<double>& body_velocity);

  WorldOptions options_;
  ContactSolver solver_;
  ContactProblem problem_;
  ContactSolution solution_;
  std::vector<TrackedContact> contacts_;
  double time_ = 0;
};

}  // namespace tetwarp::test
