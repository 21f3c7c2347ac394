/// @file cage_growth.cpp
/// Moves the vertices of cages in small steps under constraints, and accepts steps that pass the
/// check.
#include "host/simulate/start/cage_growth.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/point3.hpp"
#include "host/simulate/start/cage_pose.hpp"
#include "host/simulate/surfaces/near_pair.hpp"
#include "host/simulate/surfaces/surface_motion.hpp"

namespace tetwarp {
namespace {

constexpr int most_steps = 300;
constexpr int most_sweeps = 200;
constexpr double longest_step = 0.05;    // of the body's size
constexpr double shortest_step = 1e-4;   // of the body's size: the growth ends with shorter steps
constexpr double least_fraction = 0.03;  // of a step: with less, the step is given up
constexpr double flat_volume = 0.1;      // of the volume at rest: the least volume of an element
constexpr double shift_cost = 0.1;       // of a whole body, relative to its deformation
constexpr double wanted_distance = 1.5;  // between features after a step, in thicknesses
constexpr double least_distance = 1.05;  // between features, which a step must keep, in thicknesses

/// The sum over vertices of cages of weight direction . move must be at least `least`.
struct Constraint {
  struct Side {
    std::size_t cage = 0;
    std::vector<double> weight;  ///< [vertices of the cage]
  };
  std::vector<Side> sides;
  Point3 direction{0, 0, 0};
  double least = 0;
  double square = 0;  ///< sum of the squares of all weights
  double impulse = 0;
};

class CageGrowth {
 public:
  CageGrowth(const StartParts& parts, const std::vector<ShrunkBody>& bodies, Model& model)
      : parts_(parts), model_(model), cage_of_body_(parts.surfaces.surfaces.bodies.size(), -1) {
    for (const ShrunkBody& shrunk : bodies) {
      cage_of_body_[static_cast<std::size_t>(shrunk.body)] =
          static_cast<std::int32_t>(cages_.size());
      cages_.emplace_back(parts, model, shrunk);
    }
    moves_.resize(cages_.size());
    is_held_.assign(cages_.size(), 0);
    for (const CagePose& cage : cages_) {
      least_volume_.push_back(cage.least_volume(model, model.start));
    }
  }

  void run() {
    for (int step = 0; step < most_steps; ++step) {
      want_full_size();
      surface_places(parts_.surfaces, model_, model_.start, parts_.threads, motion_.start);
      place(1);
      find_constraints();
      project();
      double fraction = 1;
      while (fraction >= least_fraction && !is_free(fraction)) fraction /= 2;
      if (fraction < least_fraction) {
        // The cages that hinder the shortest step stop; the others continue.
        for (const std::size_t k : hindered_) is_held_[k] = 1;
        if (std::find(is_held_.begin(), is_held_.end(), 0) == is_held_.end()) return;
        continue;
      }
      if (accept(fraction) < shortest_step) return;
    }
  }

 private:
  const CollisionSurfaces& surfaces() const { return parts_.surfaces.surfaces; }

  void want_full_size() {
    for (std::size_t k = 0; k < cages_.size(); ++k) {
      const CagePose& cage = cages_[k];
      moves_[k].assign(is_held_[k] != 0 ? cage.vertex_count() : 0, {0, 0, 0});
      if (is_held_[k] != 0) continue;
      Point3 shift{0, 0, 0};
      for (std::size_t v = 0; v < cage.vertex_count(); ++v) {
        const Point3 way = minus(cage.vertices()[v], cage.target()[v]);
        shift = plus(shift, times(1 / static_cast<double>(cage.vertex_count()), way));
      }
      double largest = 0;
      for (std::size_t v = 0; v < cage.vertex_count(); ++v) {
        const Point3 wanted = plus(cage.target()[v], times(1 - shift_cost, shift));
        moves_[k].push_back(minus(wanted, cage.vertices()[v]));
        largest = std::max(largest, norm(moves_[k].back()));
      }
      const double most = longest_step * cage.size();
      if (largest <= most) continue;
      for (Point3& move : moves_[k]) move = times(most / largest, move);
    }
  }

  /// Sets motion_.end to the places after a fraction of the moves.
  void place(double fraction) {
    moved_ = model_.start;
    for (std::size_t k = 0; k < cages_.size(); ++k) {
      cages_[k].place_nodes(moves_[k], fraction, moved_);
    }
    surface_places(parts_.surfaces, model_, moved_, parts_.threads, motion_.end);
    motion_.sagitta.assign(motion_.start.vertices.size(), 0);
  }

  /// One constraint for each pair of features that the wanted moves would bring near.
  void find_constraints() {
    constraints_.clear();
    parts_.detector.begin_step();
    for (const TouchingPair& pair : parts_.detector.detect(motion_)) {
      const NearPair near = near_pair(pair, surfaces(), motion_.start);
      Constraint constraint;
      constraint.direction = near.normal;
      constraint.least = wanted_distance * surfaces().thickness - near.distance;
      for (std::size_t i = 0; i < 4 && near.vertex[i] >= 0; ++i) {
        add_vertex(near.vertex[i], near.weight[i], constraint);
      }
      for (const auto& side : constraint.sides) {
        for (const double w : side.weight) constraint.square += w * w;
      }
      if (constraint.square > 1e-20) constraints_.push_back(std::move(constraint));
    }
  }

  void add_vertex(std::int32_t vertex, double factor, Constraint& constraint) const {
    const std::int32_t cage = at(cage_of_body_, at(surfaces().vertex_body, vertex));
    if (cage < 0 || is_held_[static_cast<std::size_t>(cage)] != 0) return;
    const auto index = static_cast<std::size_t>(cage);
    auto side = std::find_if(constraint.sides.begin(), constraint.sides.end(),
                             [&](const auto& known) { return known.cage == index; });
    if (side == constraint.sides.end()) {
      constraint.sides.push_back({index, std::vector<double>(cages_[index].vertex_count(), 0.0)});
      side = constraint.sides.end() - 1;
    }
    const ModelPoint& point = at(parts_.surfaces.vertex_point, vertex);
    for (std::size_t a = 0; a < 4 && point.node[a] >= 0; ++a) {
      cages_[index].add_weights(point.node[a], factor * point.weight[a], side->weight);
    }
  }

  /// Changes the moves as little as possible so that they meet the constraints: Gauss-Seidel in the
  /// dual.
  void project() {
    const double enough = 0.1 * surfaces().thickness;
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
      double largest = 0;
      for (Constraint& constraint : constraints_) {
        double value = 0;
        for (const auto& side : constraint.sides) {
          for (std::size_t v = 0; v < side.weight.size(); ++v) {
            value += side.weight[v] * dot(constraint.direction, moves_[side.cage][v]);
          }
        }
        const double lacking = constraint.least - value;
        const double impulse = std::max(0.0, constraint.impulse + lacking / constraint.square);
        const double change = impulse - constraint.impulse;
        if (change == 0) continue;
        constraint.impulse = impulse;
        largest = std::max(largest, std::fabs(change) * constraint.square);
        for (const auto& side : constraint.sides) {
          for (std::size_t v = 0; v < side.weight.size(); ++v) {
            Point3& move = moves_[side.cage][v];
            move = plus(move, times(change * side.weight[v], constraint.direction));
          }
        }
      }
      if (largest < enough) return;
    }
  }

  /// Whether a fraction of the moves passes through nothing, ends with all pairs apart, and makes
  /// no element flat. Otherwise sets hindered_ to the cages that do not.
  bool is_free(double fraction) {
    place(fraction);
    hindered_.clear();
    for (std::size_t k = 0; k < cages_.size(); ++k) {
      const double least = cages_[k].least_volume(model_, moved_);
      if (least < std::min(flat_volume, least_volume_[k])) hindered_.push_back(k);
    }
    if (!hindered_.empty()) return false;
    parts_.detector.begin_step();
    for (const TouchingPair& pair : parts_.detector.check(motion_)) {
      hinder(near_pair(pair, surfaces(), motion_.start));
    }
    rest_.start = rest_.end = motion_.end;
    rest_.sagitta = motion_.sagitta;
    parts_.detector.begin_step();
    for (const TouchingPair& pair : parts_.detector.detect(rest_)) {
      const NearPair near = near_pair(pair, surfaces(), rest_.start);
      if (near.distance < least_distance * surfaces().thickness) hinder(near);
    }
    return hindered_.empty();
  }

  void hinder(const NearPair& near) {
    for (const std::int32_t body : near.bodies) {
      const std::int32_t cage = at(cage_of_body_, body);
      if (cage >= 0 && is_held_[static_cast<std::size_t>(cage)] == 0) {
        hindered_.push_back(static_cast<std::size_t>(cage));
      }
    }
  }

  /// @returns the largest displacement of a vertex of a cage, over the size of its body
  double accept(double fraction) {
    double largest = 0;
    for (std::size_t k = 0; k < cages_.size(); ++k) {
      std::vector<Point3>& vertices = cages_[k].vertices();
      for (std::size_t v = 0; v < vertices.size(); ++v) {
        const Point3 way = times(fraction, moves_[k][v]);
        vertices[v] = plus(vertices[v], way);
        largest = std::max(largest, norm(way) / cages_[k].size());
      }
      least_volume_[k] = cages_[k].least_volume(model_, moved_);
    }
    model_.start = moved_;
    return largest;
  }

  const StartParts& parts_;
  Model& model_;
  std::vector<std::int32_t> cage_of_body_;  ///< [bodies, then obstacles] its cage, or -1
  std::vector<CagePose> cages_;
  std::vector<std::vector<Point3>> moves_;  ///< [cages][vertices]
  std::vector<std::uint8_t> is_held_;       ///< [cages] the cage does not move any more
  std::vector<double> least_volume_;  ///< [cages] smallest volume of an element, over that at rest
  std::vector<std::size_t> hindered_;
  std::vector<Constraint> constraints_;
  ModelState moved_;
  SurfaceMotion motion_, rest_;
};

}  // namespace

void grow_by_cages(const StartParts& parts, const std::vector<ShrunkBody>& bodies, Model& model) {
  if (!bodies.empty()) CageGrowth(parts, bodies, model).run();
}

}  // namespace tetwarp
