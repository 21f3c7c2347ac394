/// @file springs.cpp
/// Divides the stiffness of couplings and handles, and loads, among selected points.
#include "host/reference/simulate/springs.hpp"

#include <numeric>

#include "host/reference/simulate/make_system.hpp"
#include "host/reference/simulate/nearest_material.hpp"
#include "host/reference/simulate/shares.hpp"
#include "host/reference/simulate/system.hpp"

namespace tetwarp::reference {
namespace {

/// The shares over their sum; equal where the sum is 0.
std::vector<double> of_one(std::vector<double> shares) {
  const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
  for (double& share : shares) {
    share = sum > 0 ? share / sum : 1 / static_cast<double>(shares.size());
  }
  return shares;
}

/// Divides the totals among springs by their shares.
void share_out(double stiffness,
               double damping,
               const std::vector<double>& all,
               std::vector<BindingSpring>& springs) {
  const std::vector<double> shares = of_one(all);
  for (std::size_t s = 0; s < springs.size(); ++s) {
    springs[s].stiffness = stiffness * shares[s];
    springs[s].damping = damping * shares[s];
  }
}

void add_coupling(std::size_t c, const State& start, System& system) {
  const Coupling& coupling = system.scene.couplings[c];
  std::vector<BindingSpring> springs;
  std::vector<double> shares;
  if (!coupling.points.empty()) {
    for (const Point3& p : coupling.points) {
      springs.push_back({tied_point(coupling.a, vector_of(p), start, system),
                         tied_point(coupling.b, vector_of(p), start, system)});
      shares.push_back(1);
    }
  } else {
    const int a = body_named(system.scene, coupling.a);
    const auto& nodes = system.geometry.coupling_nodes[c];
    const std::vector<double> all = shares_of(system, a, nodes);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const MaterialPoint point = selected_point(system, a, nodes[i]);
      const NearestMaterial nearest =
          nearest_material(coupling.b, position_of(system, start, point), start, system);
      if (coupling.within && nearest.distance > *coupling.within) continue;
      springs.push_back({point, nearest.point});
      shares.push_back(all[i]);
    }
  }
  share_out(coupling.stiffness, coupling.damping, shares, springs);
  for (BindingSpring& spring : springs) spring.coupling = static_cast<int>(c);
  system.springs.insert(system.springs.end(), springs.begin(), springs.end());
}

void add_handle(std::size_t h, const State& start, System& system) {
  const Handle& handle = system.scene.handles[h];
  const int body = body_named(system.scene, handle.body);
  std::vector<BindingSpring> springs;
  for (const int node : system.geometry.handle_nodes[h]) {
    BindingSpring spring;
    spring.a = selected_point(system, body, node);
    spring.b.local = position_of(system, start, spring.a);
    spring.handle = static_cast<int>(h);
    springs.push_back(spring);
  }
  share_out(handle.stiffness, handle.damping,
            shares_of(system, body, system.geometry.handle_nodes[h]), springs);
  system.springs.insert(system.springs.end(), springs.begin(), springs.end());
}

LoadPlace pressure_place(const System& system, int body, const std::vector<int>& selected) {
  LoadPlace place;
  const Surface& surface = system.geometry.bodies[static_cast<std::size_t>(body)].surface;
  std::vector<int> number(surface.points.size(), -1);
  for (const int index : selected) {
    number[static_cast<std::size_t>(index)] = static_cast<int>(place.points.size());
    place.points.push_back(
        system.surfaces[static_cast<std::size_t>(body)][static_cast<std::size_t>(index)]);
  }
  for (const auto& triangle : surface.triangles) {
    std::array<int, 3> corners;
    bool is_selected = true;
    for (std::size_t c = 0; c < 3; ++c) {
      corners[c] = number[static_cast<std::size_t>(triangle[c])];
      is_selected = is_selected && corners[c] >= 0;
    }
    if (is_selected) place.triangles.push_back(corners);
  }
  return place;
}

}  // namespace

void add_springs(const State& start, System& system) {
  for (std::size_t c = 0; c < system.scene.couplings.size(); ++c) add_coupling(c, start, system);
  for (std::size_t h = 0; h < system.scene.handles.size(); ++h) add_handle(h, start, system);
}

void add_loads(System& system) {
  for (std::size_t l = 0; l < system.scene.loads.size(); ++l) {
    const Load& load = system.scene.loads[l];
    const int body = body_named(system.scene, load.body);
    const auto& selected = system.geometry.load_nodes[l];
    if (load.pressure) {
      system.loads.push_back(pressure_place(system, body, selected));
      continue;
    }
    LoadPlace place;
    for (const int index : selected) place.points.push_back(selected_point(system, body, index));
    place.shares = of_one(shares_of(system, body, selected));
    system.loads.push_back(place);
  }
}

}  // namespace tetwarp::reference
