/// @file contact_laws.cpp
/// Copies arrays by the numbers of contacts.
#include "host/simulate/solve/problem/contact_laws.hpp"
#include "host/base/index_of.hpp"

namespace tetwarp {
namespace {

/// Copies the entries of some contacts, `width` numbers of each.
void gather(const std::vector<std::int32_t>& contacts,
            std::size_t width,
            const std::vector<double>& from,
            std::vector<double>& to) {
  to.clear();
  for (const std::int32_t contact : contacts) {
    const auto begin = from.begin() + static_cast<std::ptrdiff_t>(width * index_of(contact));
    to.insert(to.end(), begin, begin + static_cast<std::ptrdiff_t>(width));
  }
}

}  // namespace

void gather_laws(const std::vector<std::int32_t>& contacts,
                 const ContactProblem& from,
                 ContactProblem& to) {
  const AdhesionState& adhesion = from.adhesion;
  gather(contacts, 1, from.friction, to.friction);
  gather(contacts, 3, from.velocity_offset, to.velocity_offset);
  gather(contacts, 3, from.impulse_guess, to.impulse_guess);
  to.adhesion.time_step = adhesion.time_step;
  gather(contacts, 1, adhesion.area, to.adhesion.area);
  gather(contacts, 1, adhesion.stiffness, to.adhesion.stiffness);
  gather(contacts, 1, adhesion.tangential_stiffness, to.adhesion.tangential_stiffness);
  gather(contacts, 1, adhesion.intensity, to.adhesion.intensity);
  gather(contacts, 3, adhesion.gap, to.adhesion.gap);
  gather(contacts, 1, adhesion.energy, to.adhesion.energy);
  gather(contacts, 1, adhesion.viscosity, to.adhesion.viscosity);
  gather(contacts, 1, adhesion.bonding_rate, to.adhesion.bonding_rate);
  gather(contacts, 1, adhesion.saturation_pressure, to.adhesion.saturation_pressure);
}

}  // namespace tetwarp
