/// @file adhesion_fields.hpp
/// The numbers of an AdhesionState by their names in Python, which are those of the C++ members.
#pragma once
#include <tetwarp/contact_problem.hpp>
#include <utility>
#include <vector>

#include "python/arrays.hpp"

namespace tetwarp::python {

struct AdhesionField {
  const char* name;
  std::vector<double> AdhesionState::*member;
};

inline constexpr AdhesionField adhesion_fields[] = {
    {"area", &AdhesionState::area},
    {"stiffness", &AdhesionState::stiffness},
    {"tangential_stiffness", &AdhesionState::tangential_stiffness},
    {"intensity", &AdhesionState::intensity},
    {"gap", &AdhesionState::gap},
    {"energy", &AdhesionState::energy},
    {"viscosity", &AdhesionState::viscosity},
    {"bonding_rate", &AdhesionState::bonding_rate},
    {"saturation_pressure", &AdhesionState::saturation_pressure}};

/// The arrays that are not empty, and the time step.
inline nb::dict adhesion_dict(AdhesionState adhesion) {
  nb::dict all;
  all["time_step"] = adhesion.time_step;
  for (const AdhesionField& field : adhesion_fields) {
    std::vector<double>& numbers = adhesion.*field.member;
    if (!numbers.empty()) all[field.name] = array_of(std::move(numbers));
  }
  return all;
}

}  // namespace tetwarp::python
