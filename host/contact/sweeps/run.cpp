#include "host/contact/sweeps/run.hpp"

namespace tetwarp {
namespace {
/// Report name of the method that ContactMethods::run() starts with.
const char* first_method(ContactMethod method) {
  switch (method) {
    case ContactMethod::gauss_seidel:
      return "gauss_seidel";
    case ContactMethod::nonlinear_cg:
      return "nonlinear_cg";
    case ContactMethod::mass_splitting:
      return "mass_splitting";
    case ContactMethod::automatic:
    case ContactMethod::anderson:
    case ContactMethod::newton:
      break;
  }
  return "anderson";
}
}  // namespace

void IslandOutcome::add(const IslandEnd& end, ContactMethod method, std::int64_t contacts) {
  reason = end.reason;
  contact_updates += (end.sweeps - sweeps) * contacts;
  if (end.sweeps > sweeps) methods.push_back(first_method(method));
  if (end.has_switched) methods.push_back("nonlinear_cg");
  sweeps = end.sweeps;
}

std::vector<StopCriterion> stop_criteria(const ContactOptions& options,
                                         const ContactStructure& structure,
                                         const std::vector<IslandOutcome>& outcomes) {
  const auto islands = static_cast<std::size_t>(structure.contact_islands);
  std::vector<double> squares(islands, 0.0);
  double total = 0;
  std::int64_t contacts = 0;
  for (std::size_t i = 0; i < islands; ++i) {
    if (structure.islands[i].is_coupled) continue;
    squares[i] =
        options.measure == ContactMeasure::eta ? outcomes[i].free.eta : outcomes[i].free_square;
    total += squares[i];
    contacts += structure.islands[i].contact_count();
  }
  std::vector<StopCriterion> criteria;
  for (std::size_t i = 0; i < islands; ++i) {
    const double share =
        static_cast<double>(structure.islands[i].contact_count()) / static_cast<double>(contacts);
    const double square = (squares[i] + total * share) / 2;
    criteria.push_back({options.measure, options.tolerance, options.tolerance * std::sqrt(square)});
  }
  return criteria;
}

}  // namespace tetwarp
