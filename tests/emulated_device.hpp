/// @file emulated_device.hpp
/// Contact sweeps by the hand-mapped kernel, emulated. Include it last: it defines CUDA's names.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/contact_device.hpp"
#include "host/contact_exec_cpu.hpp"
#include "kernels/body_relax.hpp"

#include "kernels/contact_sweep.cuh"

namespace tetwarp::test {

enum class Place { shared, global };

/// The kernel by emulation, on the host's own arrays.
class EmulatedDevice final : public ContactDevice {
 public:
  explicit EmulatedDevice(Place place = Place::shared) : place_(place) {}

  std::vector<SweepProgress> sweep(const SweepTask& task,
                                   const ContactStructure& structure,
                                   const ContactSystem<double>& system,
                                   std::vector<double>& impulse) override {
    return run(task, structure, system, impulse);
  }
  std::vector<SweepProgress> sweep(const SweepTask& task,
                                   const ContactStructure& structure,
                                   const ContactSystem<float>& system,
                                   std::vector<float>& impulse) override {
    return run(task, structure, system, impulse);
  }
  std::string name() const override { return "emulation"; }

 private:
  template <class T>
  std::vector<SweepProgress> run(const SweepTask& task,
                                 const ContactStructure& structure,
                                 const ContactSystem<T>& system,
                                 std::vector<T>& best) {
    std::vector<T> impulse = best;
    if (structure.is_local) {
      return run_body(DelassusSweepBody<T>{system.delassus_view(structure),
                                           view_of(system.constants),
                                           task.switches,
                                           {},
                                           view_of(impulse)},
                      task, structure, system, best);
    }
    std::vector<T> body_velocity = system.body_free;
    CpuContactExec exec(1);
    body_relax(exec, 0, static_cast<std::int64_t>(structure.dof_start.size()) - 1,
               BodyVelocityBody<T>{structure.block_contacts(), view_of(structure.dof_start),
                                   view_of(system.response), view_of(impulse),
                                   view_of(system.body_free), view_of(body_velocity)});
    return run_body(BodySweepBody<T>{system.bodies_view(structure),
                                     view_of(system.constants),
                                     task.switches,
                                     {},
                                     view_of(impulse),
                                     view_of(body_velocity)},
                    task, structure, system, best);
  }

  template <class T, class Body>
  std::vector<SweepProgress> run_body(const Body& body,
                                      const SweepTask& task,
                                      const ContactStructure& structure,
                                      const ContactSystem<T>& system,
                                      std::vector<T>& best) {
    std::vector<T> velocity(best.size());
    std::vector<SweepProgress> progress(task.islands.size());
    SweepJob<T, Body> job;
    job.body = body;
    job.color_start = view_of(structure.color_start);
    job.free_velocity = view_of(system.free_velocity);
    job.islands = view_of(task.islands);
    job.limit = task.limit;
    job.shared_values = place_ == Place::shared ? shared_values_for<T>(job.islands) : 0;
    job.velocity = view_of(velocity);
    job.best = view_of(best);
    job.progress = view_of(progress);
    contact_sweep_islands<T, Body>(nullptr, job);
    return progress;
  }

  Place place_;
};

}  // namespace tetwarp::test
