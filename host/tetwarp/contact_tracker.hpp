/// @file contact_tracker.hpp
/// Keeps the state of contacts between rigid and deformable bodies from one time step to the next:
/// adhesion intensity, the bonded material points, and the last impulse as a start for the solver.
///
/// Order of calls in a step:
///     collision detection -> begin_step -> fill -> solve -> integrate poses -> end_step
/// Where the motion that results touches more, begin_step to solve may be repeated with a longer
/// list of contacts.
#pragma once
#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <tetwarp/contact.hpp>
#include <tetwarp/export.hpp>
#include <tetwarp/volume.hpp>

namespace tetwarp {

/// Position and rotation of a body: its point x is at position + rotation(x) [world].
struct BodyPose {
  Point3 position = {0, 0, 0};
  std::array<double, 4> rotation = {1, 0, 0, 0};  ///< quaternion w, x, y, z of length 1 within 1e-6
};

/// Where a body is: rigid bodies have a pose, deformable ones vertices.
struct BodyPlace {
  BodyPose pose = {};                     ///< of a rigid body
  std::span<const Point3> vertices = {};  ///< world positions of a deformable body; empty: rigid

  bool is_rigid() const { return vertices.empty(); }
};

/// A point of the material of a body: fixed in the frame of a rigid body, or a weighted mean of up
/// to three vertices of a deformable one.
struct MaterialPoint {
  Point3 local = {0, 0, 0};                           ///< of a rigid body
  std::array<std::int32_t, 3> vertex = {-1, -1, -1};  ///< in BodyPlace::vertices; -1: not used
  std::array<double, 3> weight = {0, 0, 0};           ///< of the vertices, sum 1

  bool is_rigid() const { return vertex[0] < 0; }
};

/// Identifies a contact by the two bodies and the features (faces, vertices, ...) that touch.
/// Bodies are indices into the poses or places; fixed obstacles are bodies too. The caller chooses
/// feature numbers and keeps them from step to step. The two bodies may be the same one if it is
/// deformable and the features differ.
struct ContactKey {
  std::int32_t body_a = 0;
  std::int32_t feature_a = 0;
  std::int32_t body_b = 0;
  std::int32_t feature_b = 0;

  auto operator<=>(const ContactKey&) const = default;
};

/// A report, a record or a solution of a contact that a tracker refuses; what() names it.
class TETWARP_EXPORT ContactKeyError : public std::invalid_argument {
 public:
  ContactKeyError(const ContactKey& key, const std::string& what)
      : std::invalid_argument(what), key_(key) {}

  const ContactKey& key() const { return key_; }

 private:
  ContactKey key_;
};

/// Constants of a pair of surfaces; units and ranges as in ContactProblem and AdhesionState.
struct ContactMaterial {
  double friction = 0;
  double stiffness = 0;
  std::optional<double> tangential_stiffness = {};  ///< `stiffness` when not given
  double energy = 0;
  double viscosity = 0;
  double bonding_rate = 0;
  double saturation_pressure = 0;
  double initial_intensity = 0;  ///< beta of a contact that touches for the first time, 0 to 1
  double restitution = 0;        ///< e, separating speed over approach speed of an impact, 0 to 1
};

/// One contact from collision detection; the contacts may come in any order, and the two bodies of
/// each in either order.
struct ReportedContact {
  ContactKey key;
  Point3 point_a_world = {0, 0, 0};  ///< on body a
  Point3 point_b_world = {0, 0, 0};  ///< on body b, the nearest to point_a_world
  Point3 normal = {0, 0, 1};         ///< unit, from b to a [world]
  double area = 0;                   ///< [m^2]
  /// The same points of deformable bodies; those of rigid bodies follow from the poses. The world
  /// point may stand off the material point along the normal, by a thickness of the surface: this
  /// distance is kept.
  MaterialPoint material_a = {}, material_b = {};
  std::int32_t material = 0;   ///< index into ContactTrackerOptions::materials
  Point3 tangent = {0, 0, 0};  ///< direction of tangent 1 [world], projected onto the tangential
                               ///< plane; zero: chosen by the tracker
  double approach_speed = 0;   ///< at which the gap closes at the start of the step, of all motions
                               ///< [m/s]; negative: opens; read only with restitution
  /// Velocity of a relative to b at the contact [world, m/s] that is not in the velocities of the
  /// problem's bodies. Of surfaces that slide over their bodies, as a conveyor belt does: poses do
  /// not show it. Contacts that are not reported have none.
  Point3 surface_velocity = {0, 0, 0};
  /// The same, of obstacles whose motion is prescribed: their poses at the end of the step contain
  /// it.
  Point3 obstacle_velocity = {0, 0, 0};
  /// Share of `area` that the bond of an earlier step covers, above 0, at most 1. Below 1, beta of
  /// the record is multiplied by it, the mean over the whole area, and its anchors go to the
  /// reported points with the tangential gap as it is.
  double bonded_share = 1;
};

/// State of a contact between steps, in body coordinates unless the name ends in _world.
///
/// Coordinates of a deformable body: an anchor is a MaterialPoint; a normal is in the frame of the
/// triangle of its three vertices. A vertex, or a point of an edge, has no such frame: there the
/// normal is zero and that of the other side counts; if neither has one, normal_a is in world axes.
struct ContactRecord {
  ContactKey key;             ///< side a has the smaller (body, feature)
  std::int32_t material = 0;  ///< index into ContactTrackerOptions::materials
  bool has_touched = false;
  double area = 0;              ///< [m^2]
  double intensity = 0;         ///< beta
  Point3 anchor_a = {0, 0, 0};  ///< material points that coincided when the bond formed
  Point3 anchor_b = {0, 0, 0};
  Point3 normal_a = {0, 0, 1};  ///< the last reported normal, in coordinates of each body
  Point3 normal_b = {0, 0, 1};
  Point3 impulse_world = {0, 0, 0};                ///< on body a in the last step [N s]
  MaterialPoint material_a = {}, material_b = {};  ///< anchors on deformable bodies
  double standoff = 0;  ///< distance along the normal between the anchors of deformable bodies at
                        ///< gap 0 [m]: thickness of the surfaces
  Point3 normal_world = {0, 0, 0};  ///< of the last step; zero: not known
};

/// One contact of the current step; the caller computes the rows of the jacobian from it.
struct TrackedContact {
  ContactKey key;
  Point3 point_a_world = {0, 0, 0};  ///< point of body a on which the impulse acts
  Point3 point_b_world = {0, 0, 0};  ///< point of body b on which the opposite impulse acts
  MaterialPoint material_a = {}, material_b = {};  ///< the same points of deformable bodies
  std::array<Point3, 3> axes = {};                 ///< normal, tangent 1, tangent 2 [world]
  Point3 gap = {0, 0, 0};  ///< components along `axes` [m]; the tangential ones between the anchors
  bool is_reported = true;  ///< false: not reported in this step, kept because it adheres
  Point3 surface_velocity = {0, 0, 0};   ///< of the report, along `axes` [m/s]
  Point3 obstacle_velocity = {0, 0, 0};  ///< of the report, along `axes` [m/s]
  double rebound_speed = 0;  ///< the least separating speed at the end of the step, by restitution
                             ///< [m/s]; 0: no impact
};

struct ContactTrackerOptions {
  std::vector<ContactMaterial> materials = {ContactMaterial{}};
  double match_distance = 0;  ///< a contact with a new key is matched with a record of the same two
                              ///< bodies whose anchor on body a is at most this far away [m] and
                              ///< whose normal differs by less than 60 degrees
  double touch_distance = 0;  ///< largest gap that counts as touching [m]
  double restitution_speed = 0;  ///< contacts that approach no faster do not rebound [m/s]
  EvolutionOptions evolution = {};
  int threads = 1;  ///< to 1024, 0: one per processor; any number: same bits
};

/// Stores the state of contacts through the steps of a simulation.
///
/// A reported contact continues the record with its key, else the nearest record of the same two
/// bodies within `match_distance`, else it is new. Contacts with adhesion are kept when collision
/// detection no longer reports them, because a bond that is pulled has a gap. A contact that
/// touches for the first time (gap within `touch_distance`, or a normal impulse > 0, its own or one
/// that presses on its area) gets `initial_intensity` of its material. The anchors of a contact
/// without adhesion follow the reported points, so that bonds form without tension; its record is
/// deleted when it is no longer reported.
///
/// A contact with restitution e that would close within the step, gap <= dt approach_speed, is an
/// impact: it separates with e approach_speed or more. Otherwise it closes at most its gap.
///
/// Contacts are sorted by key, independent of the order of the reports. A contact without area has
/// no bond. A call that throws changes nothing. A copy goes on as the tracker itself would.
class TETWARP_EXPORT ContactTracker {
 public:
  /// @param records  records() of an earlier tracker that this one continues; sorted by key
  /// @throws std::invalid_argument  a material, a record or the number of threads is out of range;
  ///                                the text names it
  explicit ContactTracker(ContactTrackerOptions options = {},
                          std::vector<ContactRecord> records = {});

  /// Starts a step: matches the reported contacts with the records. A second call before end_step()
  /// starts the same step again, from the records that the first one had found.
  /// @param places     of all bodies at the start of the step; vertices are read during the call
  /// @param time_step  dt [s], > 0, finite
  /// @return the contacts of this step, valid until the next call of begin_step()
  /// @throws std::invalid_argument  a key occurs twice, a body has no pose or touches itself, a
  ///                                normal is not a unit vector, an area is negative, a material
  ///                                does not exist, a position, velocity or pose is not finite, a
  ///                                rotation is not of length 1, time_step is not > 0 and finite,
  ///                                a contact has no material point on a deformable body or one
  ///                                with vertices or weights out of range, a bonded share is not
  ///                                above 0 and at most 1, or a body of a record has no pose
  const std::vector<TrackedContact>& begin_step(std::span<const ReportedContact> reports,
                                                std::span<const BodyPlace> places,
                                                double time_step);
  /// Of rigid bodies alone.
  const std::vector<TrackedContact>& begin_step(std::span<const ReportedContact> reports,
                                                std::span<const BodyPose> poses,
                                                double time_step);

  /// Sets velocity offset, friction, adhesion and impulse guess of a problem in global form, for
  /// the contacts of this step. The caller sets system, jacobian (rows along the axes of each
  /// contact) and load. Velocities of surfaces and obstacles, and restitution, are in the velocity
  /// offset; the caller may change it further.
  /// @throws std::logic_error  no step has begun
  void fill(ContactProblem& problem) const;

  /// Ends the step: updates intensities, anchors and impulses of the records.
  /// @param solution  of the problem that fill() completed
  /// @param places    of all bodies at the end of the step; vertices are read during the call
  /// @param pressing  normal impulse that presses on the area of each contact and so forms bonds,
  ///                  [contact_count] [N s]; empty: that of the contact itself, for contacts that
  ///                  all have an area. Where some have none, a part of the force on a surface is
  ///                  theirs, and the caller spreads it over the areas.
  /// @throws std::logic_error       no step has begun, or it has ended already
  /// @throws std::invalid_argument  a body of a record has no pose, a pose, an impulse, what
  ///                                presses or a velocity is not finite, a rotation is not of
  ///                                length 1, `pressing` has another size, or as evolve_adhesion()
  AdhesionStep end_step(const ContactSolution& solution,
                        std::span<const BodyPlace> places,
                        std::span<const double> pressing = {});
  /// Of rigid bodies alone.
  AdhesionStep end_step(const ContactSolution& solution, std::span<const BodyPose> poses);

  /// The state of all contacts, sorted by key; within a step one record for each contact of it.
  const std::vector<ContactRecord>& records() const { return records_; }
  /// The records before begin_step(), which it starts from.
  const std::vector<ContactRecord>& start_records() const {
    return is_in_step_ ? start_records_ : records_;
  }

 private:
  ContactTrackerOptions options_;
  std::vector<ContactRecord> records_;
  std::vector<ContactRecord> start_records_;  ///< of the step that has begun
  std::vector<TrackedContact> contacts_;      ///< of the last step; in it, in the order of records_
  std::vector<ContactRecord> next_records_;   ///< scratch memory of calls, as the next two
  std::vector<TrackedContact> next_contacts_;
  ContactProblem problem_;
  double time_step_ = 0;
  bool is_in_step_ = false;
};

}  // namespace tetwarp
