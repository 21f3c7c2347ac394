/// @file lattice_search.cpp
/// Searches the number of cells whose lattice comes nearest to the choice.
#include "host/scene/shapes/lattice_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "host/scene/checks/scene_checks.hpp"

namespace tetwarp {
namespace {
/// Most tetrahedra for which lattices are tried.
constexpr std::int64_t most_searched = 100'000'000;

std::array<double, 3> cell_counts(const Point3& length, double edge) {
  return {std::ceil(length[0] / edge) + 1, std::ceil(length[1] / edge) + 1,
          std::ceil(length[2] / edge) + 1};
}

/// Tries lattices and keeps the one whose number of tetrahedra is nearest to the wanted one.
class LatticeTrials {
 public:
  LatticeTrials(std::int64_t wanted,
                const std::function<LatticeFrame(double, double)>& frame_of_edge,
                const std::function<TetMesh(const LatticeFrame&)>& mesh_of)
      : wanted_(wanted), frame_of_edge_(frame_of_edge), mesh_of_(mesh_of) {}

  /// @returns the number of tetrahedra
  std::int64_t try_edge(double edge, double offset) {
    const LatticeFrame frame = frame_of_edge_(edge, offset);
    TetMesh mesh = mesh_of_(frame);
    const auto count = static_cast<std::int64_t>(mesh.tets.size());
    const std::int64_t error = std::abs(count - wanted_);
    if (best_error_ < 0 || error < best_error_) {
      best_ = {frame, std::move(mesh)};
      best_error_ = error;
      best_edge_ = edge;
    }
    return count;
  }

  bool is_near_enough() const { return best_error_ >= 0 && 200 * best_error_ <= wanted_; }
  double best_edge() const { return best_edge_; }
  ChosenLattice best() { return std::move(best_); }

 private:
  std::int64_t wanted_;
  const std::function<LatticeFrame(double, double)>& frame_of_edge_;
  const std::function<TetMesh(const LatticeFrame&)>& mesh_of_;
  ChosenLattice best_;
  std::int64_t best_error_ = -1;
  double best_edge_ = 0;
};

/// Towards the wanted number by its power law, then edges and offsets around the best.
ChosenLattice searched(std::int64_t wanted, double volume, LatticeTrials trials) {
  double edge = std::cbrt(5 * volume / static_cast<double>(wanted));
  for (int trial = 0; trial < 6 && !trials.is_near_enough(); ++trial) {
    const auto count = static_cast<double>(std::max<std::int64_t>(trials.try_edge(edge, 0), 1));
    edge *= std::clamp(std::cbrt(count / static_cast<double>(wanted)), 0.5, 2.0);
  }
  const double middle = trials.best_edge();
  for (const int step : {0, 1, -1, 2, -2, 3, -3, 4, -4, 5, -5, 6, -6}) {
    for (const double offset : {0.0, 0.25, 0.5}) {
      if (trials.is_near_enough()) return trials.best();
      trials.try_edge(middle * (1 + 0.02 * step), offset);
    }
  }
  return trials.best();
}
}  // namespace

ChosenLattice choose_lattice(const std::string& place,
                             const Lattice& choice,
                             const Bounds& bounds,
                             const Point3& length,
                             double volume,
                             const std::function<LatticeFrame(double, double)>& frame_of_edge,
                             const std::function<TetMesh(const LatticeFrame&)>& mesh_of) {
  if (choice.cells) {
    const auto& cells = *choice.cells;
    check_cells(key_of(place, "cells"),
                {static_cast<double>(cells[0]), static_cast<double>(cells[1]),
                 static_cast<double>(cells[2])});
    const LatticeFrame frame = fitted_frame(bounds, cells);
    return {frame, mesh_of(frame)};
  }
  if (choice.edge) {
    check_cells(key_of(place, "edge"), cell_counts(length, *choice.edge));
    const LatticeFrame frame = frame_of_edge(*choice.edge, 0);
    return {frame, mesh_of(frame)};
  }
  const std::int64_t wanted = choice.tets.value_or(1);
  if (wanted > most_searched) {
    fail_at(key_of(place, "tets"), "is more than 1e8; give the edge or cells instead");
  }
  return searched(wanted, volume, LatticeTrials(wanted, frame_of_edge, mesh_of));
}

}  // namespace tetwarp
