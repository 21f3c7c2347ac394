/// @file system.cpp
/// Runs the stages that fill and set up the numbers, and rounds them to float32.
#include "host/contact/structure/system.hpp"

namespace tetwarp {
namespace {
/// Slots from which constants are computed by all threads: fewer take less than the start of a
/// thread costs.
constexpr std::size_t worth_a_thread = 1024;
}  // namespace

ContactChoices choices_of(const ContactOptions& options) {
  return {options.expert.relaxation, options.expert.skip.debonded_springs,
          options.expert.skip.frictionless_rows};
}

void fill_system(const ContactProblem& problem,
                 const ContactOptions& options,
                 const ContactStructure& structure,
                 ContactSystem<double>& system,
                 ContactSavings& savings,
                 int threads) {
  CpuExec exec(structure.contact_of_slot.size() < worth_a_thread ? 1 : threads, StageClocks::off);
  system.resize(exec, structure.indices());
  savings = fill_numbers(exec, input_of(problem), structure.indices(), choices_of(options),
                         system.views());
}

ContactSystem<float> make_float32(const ContactStructure& structure,
                                  ContactSystem<double>& system) {
  ContactSystem<float> result;
  CpuExec exec(1, StageClocks::off);
  convert_system(exec, structure.indices(), system, result);
  return result;
}

}  // namespace tetwarp
