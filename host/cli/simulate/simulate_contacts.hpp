/// @file simulate_contacts.hpp
/// The contacts of a simulation: a file of points, and fields on the surfaces of bodies.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/simulate.hpp>

#include "io/vtkhdf/simulation_points.hpp"

namespace tetwarp::cli {

/// What contacts do to the surface of a body, a value per point of BodyMesh::surface.
struct ContactFields {
  std::vector<double> impulse;    ///< [points][3], on the body over the last step [N s]
  std::vector<double> intensity;  ///< largest of the point's contacts; 0 without
  std::vector<double> gap;        ///< smallest of the point's contacts, at most 100 times the
                                  ///< thickness, which is also the value without contacts [m]
};

/// The fields of all bodies after the last step. The place of a contact is a weighted mean of
/// points of the surface; each of these gets the impulse times its weight. Where a place has no
/// such points, as where a rigid body does not touch with a vertex, the nearest point gets all of
/// it.
std::vector<ContactFields> contact_fields(const Simulator& simulator);

/// The file of --contacts: the contacts at every frame as points with normal, impulse, intensity,
/// gap, area, body_a and body_b.
class ContactFile {
 public:
  /// @param kept_steps  as of BodyFiles; a file that is missing is created in any case
  ContactFile(const std::string& path, std::int64_t kept_steps);

  /// Removes the steps of an earlier run that are not kept.
  void drop_later();
  /// Appends the contacts at the end of the last step.
  void append(const Simulator& simulator);
  /// Flushes and closes the file. Throws IoError.
  void close() { writer_.close(); }

 private:
  bool is_opened_;  ///< of an earlier run; false: created
  StepPointsWriter writer_;
};

}  // namespace tetwarp::cli
