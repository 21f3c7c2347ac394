/// @file fclib.hpp
/// Names of the parts of a contact problem in an FCLIB file.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/contact_problem.hpp>

namespace tetwarp::fclib {

/// A vector of AdhesionState and its name in /adhesion.
struct AdhesionVector {
  const char* name;
  std::vector<double> AdhesionState::*member;
  std::int64_t per_contact = 1;
};

inline constexpr std::array<AdhesionVector, 9> adhesion_vectors = {{
    {"area", &AdhesionState::area},
    {"stiffness", &AdhesionState::stiffness},
    {"tangential_stiffness", &AdhesionState::tangential_stiffness},
    {"intensity", &AdhesionState::intensity},
    {"gap", &AdhesionState::gap, 3},
    {"energy", &AdhesionState::energy},
    {"viscosity", &AdhesionState::viscosity},
    {"bonding_rate", &AdhesionState::bonding_rate},
    {"saturation", &AdhesionState::saturation_pressure},
}};

/// The path inside the file of a member of ContactProblem, as ContactProblemError::field() names
/// it.
std::string path_of(const std::string& field, bool is_local);

}  // namespace tetwarp::fclib
