/// @file step_records.cpp
/// Energies, momenta, forces and counts of the last step.
#include "host/simulate/run/step_records.hpp"

#include "host/base/point3.hpp"
#include "host/simulate/run/tet_energies.hpp"
#include "host/simulate/step/scene_record.hpp"

namespace tetwarp {

const StepRecord& StepRecords::get() {
  if (record_) return *record_;
  StepRecord record;
  record.time = count_.time();
  record.bodies.resize(scene_.scene.bodies.size());
  record.obstacle_forces.assign(scene_.scene.obstacles.size(), {0, 0, 0});
  record.coupling_forces.assign(scene_.scene.couplings.size(), {0, 0, 0});
  add_state(record);
  if (count_.done() == 0) {
    record.inverted = 0;
  } else {
    add_forces(record);
    add_counts(record);
  }
  return record_.emplace(std::move(record));
}

void StepRecords::add_state(StepRecord& record) {
  const ModelState& state = bodies_.state().get();
  const TetSums tets = tet_energies(scene_.model, state, scene_.threads);
  record.energy.elastic = tets.energy;
  record.inverted = tets.inverted;
  record_state(scene_.model, state, scene_.scene.gravity, bodies_.drive().state().handles, record);
  record.energy.work = last_.work;
  record.smallest_distance = 100 * scene_.surfaces.surfaces.thickness;
  if (bodies_.contact() != nullptr) bodies_.contact()->record(state, record);
}

void StepRecords::add_forces(StepRecord& record) const {
  const StepSums& sums = last_.sums;
  const auto force = [&](const Point3& impulse) {
    return times(1 / scene_.scene.time_step, impulse);
  };
  for (std::size_t b = 0; b < record.bodies.size(); ++b) {
    BodyRecord& body = record.bodies[b];
    body.contact_force = force(sums.contact[b]);
    body.support_force = force(sums.support[b]);
    body.handle_force = force(sums.handle[b]);
    body.coupling_force = force(sums.coupling[b]);
    body.load_force = force(sums.load[b]);
  }
  for (std::size_t o = 0; o < sums.obstacle.size(); ++o) {
    record.obstacle_forces[o] = force(sums.obstacle[o]);
  }
  for (std::size_t c = 0; c < sums.on_a.size(); ++c) {
    record.coupling_forces[c] = force(sums.on_a[c]);
  }
}

void StepRecords::add_counts(StepRecord& record) const {
  const StepOutcome& outcome = last_.outcome;
  const ContactPart& contact = last_.contact;
  record.islands = bodies_.contact() != nullptr ? contact.islands : scene_.model.island_count;
  record.sleeping = bodies_.sleep().count();
  record.substeps = last_.substeps;
  record.out_of_time = last_.is_out_of_time;
  record.linear_iterations = outcome.linear_iterations;
  record.linear_residual = outcome.linear_residual;
  record.converged = outcome.converged && contact.converged;
  record.skipped_rotations = outcome.skipped_rotations;
  record.skipped_blocks = outcome.skipped_blocks;
  record.contacts = contact.contacts;
  record.contact_passes = contact.passes;
  record.clamped_islands = contact.clamped_islands;
  record.stalled_scripts = contact.stalled_scripts;
  record.sweeps = contact.sweeps;
  record.outer_iterations = contact.outer_iterations;
  record.contact_residual = contact.residual;
  record.seconds = outcome.seconds;
}

}  // namespace tetwarp
