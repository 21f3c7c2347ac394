/// @file pair_contacts.hpp
/// Makes contacts, with points, normals and areas, from the touches of a step.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/contact_tracker.hpp>

#include "host/collide/detector.hpp"
#include "host/collide/touch_areas.hpp"
#include "host/simulate/patches/rigid_patches.hpp"
#include "host/simulate/surfaces/scene_surfaces.hpp"

namespace tetwarp {

/// Makes the contacts of steps; keeps its memory between them.
///
/// Contacts of two rigid bodies that touch with faces are reduced, see RigidPatches. All others are
/// the touches that detection has chosen, see StepTouches, with keys that last from step to step.
class PairContacts {
 public:
  /// @param scene  kept by the caller
  /// @param threads  any number: same contacts
  explicit PairContacts(const SceneSurfaces& scene, int threads = 1);
  PairContacts(const PairContacts&) = delete;
  PairContacts& operator=(const PairContacts&) = delete;

  /// @param touches   Detector::touches()
  /// @param vertices  at the start of the step
  /// @param records   of the tracker at the start of the step, sorted by key
  /// @returns sorted by key, as ContactTracker::begin_step() takes them; valid until the next call.
  ///          Bodies are indices of bodies, then obstacles. Features are vertices, edges numbered
  ///          from the vertex count on (at the first and second end of an overlap plus the number
  ///          of edges once and twice), and below zero what a vertex touches: -1 the first such
  ///          contact of the vertex and the body, -2 the second; a contact takes the number of the
  ///          record whose normal is nearest. So one feature of a vertex's contact is below zero,
  ///          none of one of edges, and both of an adhesion point: no two contacts have one key.
  ///          Vertices of material points are counted from the first of the body.
  std::vector<ReportedContact>& find(std::span<const ChosenTouch> touches,
                                     const std::vector<Point3>& vertices,
                                     std::span<const ContactRecord> records = {});

 private:
  /// A record of a contact of a vertex.
  struct VertexRecord {
    std::int32_t vertex = 0, body = 0;  ///< the vertex, and the body that it touches
    std::int32_t slot = 0;              ///< its number, below 0
    std::size_t record = 0;             ///< in the records
    bool is_taken = false;              ///< a touch of the step has its number
  };

  /// A touch with the key of its contact; the sides of the key may be in the other order.
  struct NamedTouch {
    ContactKey key;
    const PairTouch* touch = nullptr;
    double area = 0;
    bool is_turned = false;
  };

  /// The touches of a vertex with one body, or one touch of edges.
  struct Group {
    std::size_t begin = 0, end = 0;
  };

  void list_groups(std::span<const ChosenTouch> touches);
  void list_records(std::span<const ContactRecord> records);
  static VertexRecord* nearest(const PairTouch& touch,
                               std::span<VertexRecord> own,
                               std::span<const ContactRecord> records);
  MaterialPoint material_of(const std::int32_t* vertex,
                            const double* weight,
                            std::int32_t body) const;
  void name_vertex(std::span<const ChosenTouch> touches,
                   const Group& group,
                   std::span<const ContactRecord> records);
  static bool is_left_to_bond(const PairTouch& touch,
                              std::span<const VertexRecord> own,
                              std::span<const ContactRecord> records);
  static NamedTouch named(const PairTouch& touch,
                          std::int32_t feature_a,
                          std::int32_t feature_b,
                          double area);
  void report(const NamedTouch& named, ReportedContact& contact) const;

  const SceneSurfaces& scene_;
  int threads_;
  TouchAreas areas_;
  RigidPatches patches_;
  std::vector<Group> groups_;
  std::vector<VertexRecord> vertex_records_;  ///< of the step, sorted by all but the record
  std::vector<NamedTouch> named_;
  std::vector<ReportedContact> contacts_;
};

}  // namespace tetwarp
