/// @file contact_tracker.hpp
/// What contacts between rigid bodies remember from step to step: how well they adhere, where, and
/// with which impulse they pushed.
///
///     collision detection -> begin_step -> fill -> solve -> integrate poses -> end_step
#pragma once
#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <tetwarp/contact.hpp>
#include <tetwarp/export.hpp>
#include <tetwarp/volume.hpp>

namespace tetwarp {

/// Where a body is: its point x is at position + rotation(x) [world].
struct BodyPose {
  Point3 position = {0, 0, 0};
  std::array<double, 4> rotation = {1, 0, 0, 0};  ///< unit quaternion w, x, y, z
};

/// Which features of which bodies touch. Bodies are indices of poses; scenery that never moves is a
/// body too. Feature numbers mean what the caller wants, as long as they stay the same.
struct ContactKey {
  std::int32_t body_a = 0;
  std::int32_t feature_a = 0;
  std::int32_t body_b = 0;
  std::int32_t feature_b = 0;

  auto operator<=>(const ContactKey&) const = default;
};

/// Constants of a pair of surfaces; units as in AdhesionState.
struct ContactMaterial {
  double friction = 0;
  double stiffness = 0;
  std::optional<double> tangential_stiffness = {};  ///< `stiffness` when not given
  double energy = 0;
  double viscosity = 0;
  double bonding_rate = 0;
  double saturation_pressure = 0;
  double initial_intensity = 0;  ///< beta of a contact that touches for the first time
};

/// One contact as collision detection sees it, in any order and either order of the bodies.
struct ReportedContact {
  ContactKey key;
  Point3 point_a_world = {0, 0, 0};  ///< on body a
  Point3 point_b_world = {0, 0, 0};  ///< on body b, nearest to it
  Point3 normal = {0, 0, 1};         ///< unit, from b to a [world]
  double area = 0;                   ///< [m^2]
  std::int32_t material = 0;
  Point3 tangent = {0, 0, 0};  ///< wanted direction of tangent 1 [world]; zero: any
};

/// What is kept of a contact between steps. Body coordinates unless the name says world.
struct ContactRecord {
  ContactKey key;  ///< smallest (body, feature) first
  std::int32_t material = 0;
  bool has_touched = false;
  double area = 0;
  double intensity = 0;
  Point3 anchor_a = {0, 0, 0};  ///< material points that coincided when the bond formed
  Point3 anchor_b = {0, 0, 0};
  Point3 normal_a = {0, 0, 1};  ///< the last reported normal, carried along by each body
  Point3 normal_b = {0, 0, 1};
  Point3 impulse_world = {0, 0, 0};  ///< on body a in the last step [N s]
};

/// One contact of the current step: what a jacobian is made of.
struct TrackedContact {
  ContactKey key;
  Point3 point_a_world = {0, 0, 0};  ///< where the impulse acts on body a
  Point3 point_b_world = {0, 0, 0};  ///< and, reversed, on body b
  std::array<Point3, 3> axes = {};   ///< normal, tangent 1, tangent 2 [world]
  Point3 gap = {0, 0, 0};            ///< along them [m]; tangents: of the anchors
  bool is_reported = true;           ///< false: kept because it adheres
};

struct ContactTrackerOptions {
  std::vector<ContactMaterial> materials = {ContactMaterial{}};
  double match_distance = 0;  ///< a contact whose features changed is still the same when its point
                              ///< on body a lies this near to the anchor there [m]
  double touch_distance = 0;  ///< a gap up to this counts as touching [m]
  EvolutionOptions evolution = {};
};

/// Follows contacts through the steps of a simulation.
///
/// A reported contact is the one it was before if its key is the same, else if it is, of all of
/// the same two bodies, the nearest within `match_distance`. Contacts that adhere are kept when
/// they are no longer reported, as a pulled contact is not. A contact that touches for the first
/// time (gap within `touch_distance`, or an impulse > 0) starts with its material's
/// `initial_intensity`. A contact without adhesion has its anchors where it is, so that bonds form
/// unstretched; it is forgotten when it is no longer reported.
///
/// The order of contacts is that of their keys, whatever the order of the reports.
class TETWARP_EXPORT ContactTracker {
 public:
  /// @param records  of an earlier tracker, to go on from; sorted by key
  /// @throws std::invalid_argument  on materials or records out of range, naming them
  explicit ContactTracker(ContactTrackerOptions options = {},
                          std::vector<ContactRecord> records = {});

  /// Matches the reports with what is known.
  /// @param poses  of all bodies at the start of the step
  /// @returns the contacts of this step, valid until the next one begins
  /// @throws std::invalid_argument  on a key that occurs twice, a body without pose or against
  ///                                itself, a normal that is no unit vector, a negative area
  const std::vector<TrackedContact>& begin_step(std::span<const ReportedContact> reports,
                                                std::span<const BodyPose> poses,
                                                double time_step);

  /// Sets what the tracker knows of a problem in global form: velocity offset, friction, adhesion,
  /// impulse guess. The caller adds system, jacobian (rows: axes of each contact) and load.
  void fill(ContactProblem& problem) const;

  /// Takes the solution: intensities, bonds that form or let go, impulses to start from.
  /// @param poses  of all bodies at the end of the step
  AdhesionStep end_step(const ContactSolution& solution, std::span<const BodyPose> poses);

  /// Everything that is remembered, sorted by key.
  const std::vector<ContactRecord>& records() const { return records_; }

 private:
  ContactTrackerOptions options_;
  std::vector<ContactRecord> records_;
  std::vector<TrackedContact> contacts_;  // of the step, as many as records
  double time_step_ = 0;
};

}  // namespace tetwarp
