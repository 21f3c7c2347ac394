/// @file start_push.cpp
/// Solves for displacements as a contact problem without friction and forces, until the touches of
/// the displaced surfaces have no negative gaps.
#include "host/simulate/start/start_push.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <tetwarp/contact.hpp>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"
#include "host/collide/touch_areas.hpp"
#include "host/simulate/start/inset_places.hpp"
#include "host/simulate/start/start_check.hpp"
#include "host/simulate/start/start_movers.hpp"
#include "host/simulate/surfaces/surface_motion.hpp"

namespace tetwarp {
namespace {

constexpr int most_rounds = 30;
constexpr int most_halvings = 5;
constexpr double least_gain = 0.99;  // a round that leaves more of what is missing has not helped
constexpr double wanted = 1.001;     // distance, in thicknesses: solutions are not exact
constexpr double least_mass = 1e-9;  // of the largest one: nodes may have none
// Directions of pairs that are nearer than this many roundings of their coordinates are those of
// faces, if one is within 45 degrees.
constexpr double rounded_distances = 100;

class StartPush {
 public:
  StartPush(const StartParts& parts, Model& model)
      : parts_(parts),
        surfaces_(parts.surfaces.surfaces),
        areas_(parts.surfaces.surfaces),
        model_(model),
        movers_(model) {}

  std::vector<std::uint8_t> run() {
    const ModelState before = model_.start;
    find_places(model_.start, places_);
    double lack = lack_at(places_);
    for (int round = 0; round < most_rounds && lack > 0; ++round) {
      const double left = moved_by(solved(), lack);
      if (left <= least_gain * lack) {
        lack = left;
      } else if (movers_.are_divided()) {
        break;
      } else {
        movers_.divide();
      }
    }
    return changed_since(before);
  }

 private:
  void find_places(const ModelState& state, SurfacePlaces& places) const {
    surface_places(parts_.surfaces, model_, state, parts_.threads, places);
  }
  /// The sum over pairs of bodies of what is missing to the thickness; infinite where surfaces
  /// intersect.
  double lack_at(const SurfacePlaces& places) {
    double lack = 0;
    for (const StartConflict& conflict :
         start_conflicts(parts_.surfaces, places, parts_.detector, parts_.threads)) {
      if (conflict.is_intersection()) return HUGE_VAL;
      lack += surfaces_.thickness - conflict.distance;
    }
    return lack;
  }

  /// Displacements of all movers that make the gaps of the touches at places_ at least 0.
  std::vector<double> solved() {
    const InsetPlaces inset(surfaces_, places_);
    const SurfaceMotion rest{inset.places(), inset.places(),
                             std::vector<double>(places_.vertices.size(), 0.0)};
    parts_.detector.begin_step();
    parts_.detector.find_touches(rest);
    ContactProblem problem = problem_of_masses();
    for (const ChosenTouch& chosen : parts_.detector.touches()) {
      add_touch(chosen.touch, inset, problem);
    }
    if (problem.friction.empty()) return {};
    ContactOptions options;
    options.tolerance = 1e-4;
    options.threads = parts_.threads;
    return solve_contacts(problem, options).body_velocity;
  }

  ContactProblem problem_of_masses() const {
    ContactProblem problem;
    const std::int32_t count = 3 * movers_.count();
    double largest = 0;
    for (std::int32_t m = 0; m < movers_.count(); ++m) largest = std::max(largest, movers_.mass(m));
    problem.system = {count, count, {0}, {}, {}};
    problem.jacobian = {0, count, {0}, {}, {}};
    problem.load.assign(index_of(count), 0);
    problem.block_start = {0};
    for (std::int32_t d = 0; d < count; ++d) {
      problem.system.column.push_back(d);
      problem.system.value.push_back(std::max(movers_.mass(d / 3), least_mass * largest));
      problem.system.row_start.push_back(d + 1);
      if (d % 3 == 2) problem.block_start.push_back(d + 1);
    }
    return problem;
  }

  void add_touch(const PairTouch& touch, const InsetPlaces& inset, ContactProblem& problem) {
    shares_.clear();
    Point3 apart{0, 0, 0}, inwards{0, 0, 0};
    for (const double side : {1.0, -1.0}) {
      const auto* const vertex = side > 0 ? touch.vertex_a : touch.vertex_b;
      const auto* const weight = side > 0 ? touch.weight_a : touch.weight_b;
      for (int k = 0; k < 3 && vertex[k] >= 0; ++k) {
        const Point3& x = at(places_.vertices, vertex[k]);
        const Point3 way = minus(at(inset.places().vertices, vertex[k]), x);
        apart = plus(apart, times(side * weight[k], x));
        inwards = plus(inwards, times(side * weight[k], way));
        movers_.add_shares(at(parts_.surfaces.vertex_point, vertex[k]), side * weight[k], shares_);
      }
    }
    Point3 normal = point_of(touch.normal);
    double gap = touch.gap - dot(normal, inwards);
    if (is_within_rounding(touch, inset)) {
      normal = face_direction(touch, normal);
      gap = dot(normal, apart) - surfaces_.thickness;
    }
    gap -= (wanted - 1) * surfaces_.thickness;
    const bool may_move = std::ranges::any_of(
        shares_, [](const StartMovers::Share& of) { return std::fabs(of.weight) > 1e-6; });
    if (!may_move) return;
    const Point3 away = std::fabs(normal[0]) < 0.6 ? Point3{1, 0, 0} : Point3{0, 1, 0};
    const Point3 tangent = unit(cross(normal, away));
    for (const Point3& axis : {normal, tangent, cross(normal, tangent)}) {
      for (const StartMovers::Share& share : shares_) {
        for (std::int32_t d = 0; d < 3; ++d) {
          problem.jacobian.column.push_back(3 * share.mover + d);
          problem.jacobian.value.push_back(share.weight * axis[index_of(d)]);
        }
      }
      problem.jacobian.row_start.push_back(std::ssize(problem.jacobian.column));
      ++problem.jacobian.rows;
    }
    problem.velocity_offset.insert(problem.velocity_offset.end(), {gap, 0, 0});
    problem.friction.push_back(0);
  }
  /// Whether the direction of a touch of two meshes may be one of rounding alone.
  bool is_within_rounding(const PairTouch& touch, const InsetPlaces& inset) const {
    const double rounding = inset.rounding(touch.body_a) + inset.rounding(touch.body_b);
    if (touch.distance > rounded_distances * rounding || touch.vertex_b[0] < 0) return false;
    return at(surfaces_.vertex_radius, touch.vertex_a[0]) == 0 &&
           at(surfaces_.vertex_radius, touch.vertex_b[0]) == 0;
  }
  /// Of the normals of the triangles around a touch, and of the direction across two edges, the one
  /// nearest to `normal`, if it is within 45 degrees; else `normal`.
  Point3 face_direction(const PairTouch& touch, const Point3& normal) const {
    Point3 best = normal;
    double closest = cosine_45;
    const auto offer = [&](const Point3& direction) {
      if (!(norm(direction) > 0) || !(dot(unit(direction), normal) > closest)) return;
      best = unit(direction);
      closest = dot(best, normal);
    };
    visit_triangles(touch.vertex_a, touch.weight_a, [&](const Point3& n) { offer(times(-1, n)); });
    visit_triangles(touch.vertex_b, touch.weight_b, offer);
    if (!touch.is_of_edges()) return best;
    const auto along = [&](const std::int32_t* vertex) {
      return minus(at(places_.vertices, vertex[1]), at(places_.vertices, vertex[0]));
    };
    const Point3 across = cross(along(touch.vertex_a), along(touch.vertex_b));
    offer(across);
    offer(times(-1, across));
    return best;
  }
  /// Visits the normals of the triangles that have all vertices of a point with a weight.
  template <class Visit>
  void visit_triangles(const std::int32_t* vertex, const double* weight, const Visit& visit) const {
    constexpr double least_weight = 1e-6;
    std::vector<std::int32_t> of;
    for (int k = 0; k < 3 && vertex[k] >= 0; ++k) {
      if (weight[k] > least_weight) of.push_back(vertex[k]);
    }
    for (const std::int32_t t : areas_.triangles_around(of[0])) {
      const auto& corner = at(surfaces_.triangles, t);
      if (!std::ranges::all_of(
              of, [&](std::int32_t v) { return std::ranges::find(corner, v) != corner.end(); })) {
        continue;
      }
      const Point3& x = at(places_.vertices, corner[0]);
      visit(cross(minus(at(places_.vertices, corner[1]), x),
                  minus(at(places_.vertices, corner[2]), x)));
    }
  }
  /// Moves by the largest of the fractions 1, 1/2, ... that leaves less lack than before.
  /// @returns the lack that is left; not less than before: nothing has moved
  double moved_by(const std::vector<double>& way, double lack) {
    if (way.empty() || !std::ranges::all_of(way, [](double x) { return std::isfinite(x); })) {
      return lack;
    }
    double fraction = 1;
    for (int halving = 0; halving <= most_halvings; ++halving, fraction /= 2) {
      ModelState state = model_.start;
      movers_.move(way, fraction, state);
      SurfacePlaces places;
      find_places(state, places);
      const double left = passes_through(places) ? HUGE_VAL : lack_at(places);
      if (!(left < lack)) continue;
      model_.start = std::move(state);
      places_ = std::move(places);
      return left;
    }
    return lack;
  }
  /// Whether surfaces that are apart hit each other on the way to other places.
  bool passes_through(const SurfacePlaces& end) {
    const SurfaceMotion motion{places_, end, std::vector<double>(places_.vertices.size(), 0.0)};
    parts_.detector.begin_step();
    return std::ranges::any_of(parts_.detector.check(motion), [this](const TouchingPair& pair) {
      return pair.start_distance > surfaces_.thickness;
    });
  }

  std::vector<std::uint8_t> changed_since(const ModelState& before) const {
    std::vector<std::uint8_t> has_changed(model_.body_rigid.size(), 0);
    const auto differs = [&](std::int64_t place) {
      return before.position[index_of(place)] != model_.start.position[index_of(place)];
    };
    for (std::size_t b = 0; b < has_changed.size(); ++b) {
      bool moved = model_.body_rigid[b] >= 0 && differs(model_.node_count + model_.body_rigid[b]);
      for (auto n = model_.body_node[b]; n < model_.body_node[b + 1]; ++n) {
        moved = moved || differs(n);
      }
      has_changed[b] = moved;
    }
    return has_changed;
  }

  const StartParts& parts_;
  const CollisionSurfaces& surfaces_;
  const TouchAreas areas_;  ///< the triangles around each vertex
  Model& model_;
  StartMovers movers_;
  SurfacePlaces places_;  ///< of model_.start
  std::vector<StartMovers::Share> shares_;
};

}  // namespace

std::vector<std::uint8_t> push_apart(const StartParts& parts, Model& model) {
  return StartPush(parts, model).run();
}

}  // namespace tetwarp
