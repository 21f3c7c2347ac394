/// @file hand_contacts.hpp
/// Scenes whose contacts are given by hand: which points touch and along which normal.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <tetwarp/contact_tracker.hpp>

#include "host/simulate/solve/contact_system.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp::test {

inline std::size_t at(std::int64_t index) {
  return static_cast<std::size_t>(index);
}

/// Two points that touch; body a is the smaller one.
struct Touch {
  std::int32_t body_a = 0, body_b = 0;
  MaterialPoint point_a, point_b;  ///< vertices of deformable bodies are their nodes from 0 on;
                                   ///< `local` of rigid ones is from the center in principal axes
  Point3 normal{0, 0, 1};          ///< from b to a
  double area = 0;                 ///< [m^2]
  std::int32_t material = 0;
  Point3 obstacle_velocity{0, 0, 0};
};

/// A model whose nodes are all vertices of the surfaces.
struct HandScene {
  Model model;
  SceneSurfaces surfaces;
  std::vector<Touch> touches;

  /// Fills `surfaces`; after the last body.
  void make_surfaces(double body_size);
  Point3 place_of(std::int32_t body, const MaterialPoint& point, const ModelState& state) const;
  std::vector<ReportedContact> reports(const ModelState& state) const;
  /// Begins a step of the tracker.
  std::vector<TrackedContact> begin(ContactTracker& tracker,
                                    const ModelState& state,
                                    double time_step) const;
  /// J^T r on all blocks, [block_count].
  /// @param impulse  r, [3 contacts]
  std::vector<Point3> block_impulses(const ModelState& state,
                                     const std::vector<TrackedContact>& contacts,
                                     const std::vector<double>& impulse) const;
  /// Of all bodies; refers to the positions of the state.
  std::vector<BodyPlace> places(const ModelState& state) const;
};

MaterialPoint on_nodes(const std::array<std::int32_t, 3>& vertex,
                       const std::array<double, 3>& weight);
MaterialPoint on_rigid(const Point3& local);

/// Appends a frame without mass, whose velocity is prescribed. @returns its number
std::int32_t add_frame(Model& model, const Point3& center);
/// Prescribes the velocity of a node.
void prescribe(Model& model, std::int32_t block);

}  // namespace tetwarp::test
