/// @file run.cpp
/// Adds the results of islands, and shares out the allowed error among them.
#include "host/contact/sweeps/run.hpp"

#include "host/contact/sweeps/method_names.hpp"

namespace tetwarp {
namespace {
/// The method with which ContactMethods::run() starts.
ContactMethod first_method(ContactMethod method) {
  const bool starts_with_anderson =
      method == ContactMethod::automatic || method == ContactMethod::newton;
  return starts_with_anderson ? ContactMethod::anderson : method;
}
}  // namespace

void IslandOutcome::add(const IslandEnd& end, ContactMethod method, std::int64_t contacts) {
  reason = end.reason;
  contact_updates += (end.sweeps - sweeps) * contacts;
  if (end.sweeps > sweeps) methods.push_back(report_name_of(first_method(method)));
  if (end.has_switched) methods.push_back(report_name_of(ContactMethod::nonlinear_cg));
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
