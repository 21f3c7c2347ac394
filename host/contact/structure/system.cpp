/// @file system.cpp
#include "host/contact/structure/system.hpp"

namespace tetwarp {

ContactInput input_of(const ContactProblem& problem) {
  ContactInput in;
  const bool is_local = problem.is_local();
  in.matrix = view_of(is_local ? problem.delassus.value : problem.system.value);
  in.jacobian = view_of(problem.jacobian.value);
  in.load = view_of(problem.load);
  in.given_velocity = view_of(is_local ? problem.free_velocity : problem.velocity_offset);
  in.friction = view_of(problem.friction);
  const AdhesionState& adhesion = problem.adhesion;
  in.has_adhesion = !adhesion.empty();
  in.time_step = adhesion.time_step;
  in.area = view_of(adhesion.area);
  in.stiffness = view_of(adhesion.stiffness);
  in.tangential_stiffness = view_of(adhesion.tangential_stiffness);
  in.intensity = view_of(adhesion.intensity);
  in.gap = view_of(adhesion.gap);
  return in;
}

ContactChoices choices_of(const ContactOptions& options) {
  return {options.relaxation, options.skip.debonded_springs, options.skip.frictionless_rows};
}

void fill_system(const ContactProblem& problem,
                 const ContactOptions& options,
                 const ContactStructure& structure,
                 ContactSystem<double>& system,
                 ContactSavings& savings,
                 int threads) {
  CpuContactExec exec(threads);
  system.resize(exec, structure.indices());
  savings = fill_numbers(exec, input_of(problem), structure.indices(), choices_of(options),
                         system.views());
}

ContactSystem<float> make_float32(const ContactStructure& structure,
                                  ContactSystem<double>& system) {
  ContactSystem<float> result;
  CpuContactExec exec(1);
  convert_system(exec, structure.indices(), system, result);
  return result;
}

}  // namespace tetwarp
