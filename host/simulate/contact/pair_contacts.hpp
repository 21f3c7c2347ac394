/// @file pair_contacts.hpp
/// Contacts, with points, normals and areas, from the pairs that a detection found.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/contact_tracker.hpp>

#include "host/collide/detector.hpp"
#include "host/simulate/contact/pair_touch.hpp"
#include "host/simulate/contact/rigid_patches.hpp"
#include "host/simulate/contact/scene_surfaces.hpp"
#include "host/simulate/contact/touch_area.hpp"

namespace tetwarp {

/// Makes the contacts of steps; keeps its memory between them.
///
/// Of each pair: the nearest points and the normal at the time of the hit, or at the start where it
/// is near only; gap at the start less the thickness. The points are those of the material at the
/// start, moved along the normal so that they are `gap` apart: on the side that does not move, else
/// on that of a rigid body against a deformable one, else by half on each.
///
/// Which pairs become contacts:
/// - A vertex touches another body once, at the nearest face, plane or round part. Other parts of
///   the body count, too, where they face elsewhere: by more than 45 degrees, or by more than 5 at
///   a point inside a face. A round part touches by more than 5 degrees elsewhere also what is at
///   most a quarter of the thickness further at the start: a ball in a ring touches the whole ring.
///   No part counts at an edge or corner that they share with a nearer one. A
///   vertex next to an edge between even faces so has one contact, and slides over the edge.
/// - Two edges touch where they cross. Where an end of one is nearest, its vertex touches already.
///   Edges that are near without a hit must be what is nearest of their surfaces: an edge within an
///   even face does not hold up what passes over it.
/// - Two capsules touch where they are nearest; side by side, to 10 degrees, at both ends of their
///   overlap, and between these where they are nearer there by a tenth of the thickness.
/// - Contacts of two rigid bodies that touch with faces are reduced, see RigidPatches.
///
/// Areas are those of the vertices that touch, seen along the normal, so that they add up to the
/// area that touches; those of two meshes are shared by fineness. Edges and round parts have none.
class PairContacts {
 public:
  /// @param scene  kept by the caller
  /// @param threads  any number: same contacts
  explicit PairContacts(const SceneSurfaces& scene, int threads = 1);
  PairContacts(const PairContacts&) = delete;
  PairContacts& operator=(const PairContacts&) = delete;

  /// @param pairs    of all detections of the step, sorted, each once
  /// @param pass     [pairs] the detection that found each pair: an index of `motions`. Times of
  ///                 hits are those of its motion
  /// @param motions  of the detections; all have the same start; tangents follow the first
  /// @param records  of the tracker at the start of the step, sorted by key
  /// @returns sorted by key, as ContactTracker::begin_step() takes them; valid until the next call.
  ///          Bodies are indices of bodies, then obstacles. Features are vertices, edges numbered
  ///          from the vertex count on (at the first and second end of an overlap plus the number
  ///          of edges once and twice), and below zero what a vertex touches: -1 the first such
  ///          contact of the vertex and the body, -2 the second; a contact takes the number of the
  ///          record whose normal is nearest. Vertices of material points are
  ///          counted from the first of the body.
  const std::vector<ReportedContact>& find(const std::vector<TouchingPair>& pairs,
                                           std::span<const std::int32_t> pass,
                                           std::span<const SurfaceMotion> motions,
                                           std::span<const ContactRecord> records = {});

 private:
  /// A record of the tracker of a vertex.
  struct VertexRecord {
    std::int32_t vertex = 0, body = 0;  ///< what touches, and the body that it touches
    std::int32_t slot = 0;              ///< its number, below 0
    std::size_t record = 0;             ///< in the records
  };

  bool is_nearest_of_edges(const PairTouch& touch, const std::vector<Point3>& vertices) const;
  void add_touches(const TouchingPair& pair,
                   const SurfaceMotion& motion,
                   const SurfaceMotion& first,
                   std::vector<PairTouch>& touches) const;
  void choose(std::size_t first, std::size_t end);
  std::int32_t slot_of(const PairTouch& touch, std::span<const ContactRecord> records) const;
  void list_records(std::span<const ContactRecord> records);
  void report(const PairTouch& touch, std::int32_t feature_a, std::int32_t feature_b, double area);
  void report_vertex(std::size_t first,
                     std::size_t end,
                     const std::vector<Point3>& vertices,
                     std::span<const ContactRecord> records);

  const SceneSurfaces& scene_;
  int threads_;
  TouchAreas areas_;
  RigidPatches patches_;
  std::vector<std::vector<PairTouch>> parts_;  ///< touches of runs of pairs
  std::vector<PairTouch> touches_;
  std::vector<std::size_t> order_;   ///< of touches_, by vertex and body touched, then distance
  std::vector<std::size_t> kept_;    ///< of the current vertex and body, in touches_
  std::vector<std::int32_t> slots_;  ///< taken by them
  std::vector<VertexRecord> vertex_records_;  ///< of the step, sorted by all but the record
  std::vector<ReportedContact> contacts_;
};

/// PairContacts::find() without memory.
std::vector<ReportedContact> contacts_of(const std::vector<TouchingPair>& pairs,
                                         std::span<const std::int32_t> pass,
                                         const SceneSurfaces& scene,
                                         std::span<const SurfaceMotion> motions);

}  // namespace tetwarp
