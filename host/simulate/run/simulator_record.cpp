#include "host/base/parallel.hpp"
#include "host/simulate/model/rotations.hpp"
#include "host/simulate/run/simulator_impl.hpp"
#include "host/simulate/run/tet_energies.hpp"
#include "host/simulate/step/scene_record.hpp"

namespace tetwarp {

const StepRecord& Simulator::Impl::record() {
  if (record_) return *record_;
  StepRecord record;
  record.time = time_of(static_cast<double>(step_index));
  record.bodies.resize(scene.bodies.size());
  record.obstacle_forces.assign(scene.obstacles.size(), {0, 0, 0});
  record.coupling_forces.assign(scene.couplings.size(), {0, 0, 0});
  const TetSums tets = tet_energies(model, state(), thread_count(options.threads));
  record.energy.elastic = tets.energy;
  record.inverted = tets.inverted;
  record_state(model, state(), scene.gravity, drive.handles(), record);
  record.energy.work = work_;
  record.smallest_distance = 100 * contact_surfaces.surfaces.thickness;
  if (contact_) contact_->record(state(), record);
  if (step_index == 0) {
    record.inverted = 0;
    return record_.emplace(std::move(record));
  }
  const auto force = [&](const Point3& impulse) { return times(1 / scene.time_step, impulse); };
  for (std::size_t b = 0; b < record.bodies.size(); ++b) {
    record.bodies[b].contact_force = force(sums_.contact[b]);
    record.bodies[b].support_force = force(sums_.support[b]);
    record.bodies[b].handle_force = force(sums_.handle[b]);
    record.bodies[b].coupling_force = force(sums_.coupling[b]);
    record.bodies[b].load_force = force(sums_.load[b]);
  }
  for (std::size_t o = 0; o < sums_.obstacle.size(); ++o) {
    record.obstacle_forces[o] = force(sums_.obstacle[o]);
  }
  for (std::size_t c = 0; c < sums_.on_a.size(); ++c) {
    record.coupling_forces[c] = force(sums_.on_a[c]);
  }
  record.islands = contact_ ? contact_of_step_.islands : model.island_count;
  record.sleeping = sleeping_;
  record.substeps = substeps_;
  record.linear_iterations = outcome_.linear_iterations;
  record.linear_residual = outcome_.linear_residual;
  record.converged = outcome_.converged && contact_of_step_.converged;
  record.skipped_rotations = outcome_.skipped_rotations;
  record.skipped_blocks = outcome_.skipped_blocks;
  record.contacts = contact_of_step_.contacts;
  record.contact_passes = contact_of_step_.passes;
  record.clamped_islands = contact_of_step_.clamped_islands;
  record.stalled_scripts = contact_of_step_.stalled_scripts;
  record.sweeps = contact_of_step_.sweeps;
  record.outer_iterations = contact_of_step_.outer_iterations;
  record.contact_residual = contact_of_step_.residual;
  record.seconds = outcome_.seconds;
  return record_.emplace(std::move(record));
}

}  // namespace tetwarp
