/// @file fclib.cpp
/// Paths of the members of a contact problem.
#include "io/fclib/fclib.hpp"

namespace tetwarp::fclib {

std::string path_of(const std::string& field, bool is_local) {
  const std::string root = is_local ? "/fclib_local/" : "/fclib_global/";
  const std::array<std::pair<const char*, std::string>, 18> paths = {{
      {"system", root + "M"},
      {"jacobian", root + "H"},
      {"load", root + "vectors/f"},
      {"velocity_offset", root + "vectors/w"},
      {"delassus", root + "W"},
      {"free_velocity", root + "vectors/q"},
      {"friction", root + "vectors/mu"},
      {"block_start", "/blocks/block_ptr"},
      {"impulse_guess", "/guesses/1/r"},
      {"adhesion.saturation_pressure", "/adhesion/saturation"},
      {"second_friction", "/friction/second"},
      {"bilateral.jacobian", root + "G"},
      {"bilateral.target", root + "vectors/b"},
      {"bilateral.compliance", "/bilateral/compliance"},
      {"bilateral.group_start", "/bilateral/group_ptr"},
      {"bilateral.impulse_guess", "/guesses/1/l"},
      {"rolling.jacobian", "/rolling/H"},
      {"rolling.impulse_guess", "/guesses/1/m"},
  }};
  for (const auto& [member, path] : paths) {
    if (field.starts_with(member)) return path;
  }
  const std::string adhesion = "adhesion.";
  if (field.starts_with(adhesion)) return "/adhesion/" + field.substr(adhesion.size());
  const std::string rolling = "rolling.";
  if (field.starts_with(rolling)) return "/rolling/" + field.substr(rolling.size());
  return root.substr(0, root.size() - 1);
}

}  // namespace tetwarp::fclib
