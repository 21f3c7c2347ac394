/// @file island_solves.hpp
/// Islands of contacts solved by the emulated device, on the host's own arrays.
#pragma once
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "host/contact/sweeps/run.hpp"
#include "tests/support/contact/contact_stages.hpp"
#include "tests/support/contact/contact_sweeps.hpp"

#include "kernels/contact/cuda/contact_block.cuh"
#include "kernels/contact/cuda/grid_island.cuh"

namespace tetwarp::test {

inline ContactSystem<double> system_in(const SweepScene& scene, double) {
  return scene.system;
}
inline ContactSystem<float> system_in(const SweepScene& scene, float) {
  ContactSystem<double> system = scene.system;
  return make_float32(scene.structure, system);
}

template <class T>
bool has_bits_of(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

/// Where an island's arrays are, and which threads solve it.
enum class Place { shared, partly_shared, global, shared_by_warps, global_by_warps };

constexpr Place places[] = {Place::shared, Place::partly_shared, Place::global,
                            Place::shared_by_warps, Place::global_by_warps};

/// All islands of a scene, from small impulses.
template <class T>
class IslandSolves {
 public:
  IslandSolves(const SweepScene& scene, const MethodPlan& plan, const StopCriterion& criterion)
      : scene_(scene), system_(system_in(scene, T{})), plan_(plan), criterion_(criterion) {}

  ContactSwitches switches;
  std::int64_t events = 32;  ///< room for each island
  bool freezes = false;
  bool measures = true;  ///< the results of blocks, by another launch

  /// Impulses by blocks; `results` and `logs` of each island.
  std::vector<T> by_blocks(Place place) {
    StateMemory<CpuExec, T> state = start();
    MethodMemory<CpuExec, T> work;
    std::vector<IslandTask> tasks;
    const ContactIndices indices = scene_.structure.indices();
    for (const ContactIsland& island : islands()) {
      tasks.push_back({island, criterion_, island_arrays(indices, island)});
    }
    results.assign(tasks.size(), {});
    logs.assign(tasks.size() * static_cast<std::size_t>(events), {-1, -1});
    IslandJob<T> job = {system_.numbers(indices),
                        state.views(),
                        work.reserve(slots()),
                        view_of(scene_.structure.color_start),
                        switches,
                        plan_,
                        view_of(std::as_const(tasks)),
                        0,
                        view_of(results),
                        view_of(logs),
                        events};
    const std::int64_t most =
        place == Place::partly_shared ? 4096 : simt::Device::only().most_shared_bytes;
    if (place == Place::shared_by_warps || place == Place::global_by_warps) {
      if (place == Place::shared_by_warps) {
        job.shared_bytes = shared_bytes_for<T, 32>(job.tasks, indices.is_local, most);
      }
      contact_solve_islands<T, 32>(nullptr, job);
    } else {
      if (place != Place::global) {
        job.shared_bytes = shared_bytes_for<T, island_threads>(job.tasks, indices.is_local, most);
      }
      contact_solve_islands<T>(nullptr, job);
    }
    if (!measures) return state.impulse;
    sums.assign(tasks.size(), {});
    contact_measure_islands<T>(nullptr,
                               {system_.numbers(scene_.structure.indices()),
                                state.views(),
                                view_of(scene_.structure.color_start),
                                switches,
                                {islands().data(), static_cast<std::int64_t>(islands().size())},
                                view_of(sums)});
    return state.impulse;
  }

  /// Impulses of a problem of one island by a grid of so many blocks.
  std::vector<T> by_grid(unsigned blocks) {
    StateMemory<CpuExec, T> state = start();
    MethodMemory<CpuExec, T> work;
    const ContactIsland& island = islands()[0];
    const std::int64_t terms = most_terms_of(island);
    std::vector<LargestSum> sums(static_cast<std::size_t>(GridTeam::sum_bytes(terms)) /
                                 sizeof(LargestSum));
    std::vector<LargestSum> method_state(GridExec::state_bytes / sizeof(LargestSum) + 1);
    results.assign(1, {});
    logs.assign(static_cast<std::size_t>(events), {-1, -1});
    const GridIslandJob<T> job = {system_.numbers(scene_.structure.indices()),
                                  state.views(),
                                  work.reserve(slots()),
                                  view_of(scene_.structure.color_start),
                                  switches,
                                  plan_,
                                  IslandTask{island, criterion_},
                                  method_state.data(),
                                  sums.data(),
                                  terms,
                                  view_of(results),
                                  view_of(logs)};
    simt::launch_cooperative(contact_grid_kernel<T>, dim3(blocks), dim3(island_threads),
                             GridTeam::shared_bytes, job);
    return state.impulse;
  }

  /// By the host, one island after the other.
  std::vector<T> by_host() {
    StateMemory<CpuExec, T> state = start();
    MethodMemory<CpuExec, T> work;
    CpuExec exec(1);
    host_ends.clear();
    host_sums.clear();
    host_logs.clear();
    for (const ContactIsland& island : islands()) {
      ContactPipeline<CpuExec, T> pipeline(exec, system_.numbers(scene_.structure.indices()),
                                           view_of(scene_.structure.color_start), island, switches,
                                           state.views());
      HostEventLog log;
      host_ends.push_back(solve_island(pipeline, criterion_, plan_, 0, work.reserve(slots()), log));
      host_sums.push_back(pipeline.measure());
      host_logs.push_back(log.events);
    }
    return state.impulse;
  }

  std::vector<IslandResult> results;
  std::vector<IslandSums> sums;  ///< of the results of the blocks
  std::vector<ContactEvent> logs;
  std::vector<IslandEnd> host_ends;
  std::vector<ContactSums> host_sums;
  std::vector<std::vector<ContactEvent>> host_logs;

 private:
  std::span<const ContactIsland> islands() const {
    return {scene_.structure.islands.data(),
            static_cast<std::size_t>(scene_.structure.contact_islands)};
  }
  std::int64_t slots() const { return scene_.structure.indices().slots(); }
  StateMemory<CpuExec, T> start() const {
    CpuExec exec(1);
    StateMemory<CpuExec, T> state;
    state.reset(exec, system_.numbers(scene_.structure.indices()), freezes);
    state.impulse.assign(state.impulse.size(), T(0.001));
    return state;
  }

  const SweepScene& scene_;
  ContactSystem<T> system_;
  MethodPlan plan_;
  StopCriterion criterion_;
};

}  // namespace tetwarp::test
