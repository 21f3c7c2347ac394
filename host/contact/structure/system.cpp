#include "host/contact/structure/system.hpp"

namespace tetwarp {

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
