/// @file fclib_left_out.cpp
/// Compares the names in a file with those that are read.
#include "io/fclib/fclib_left_out.hpp"

#include <algorithm>
#include <map>

#include "io/fclib/fclib.hpp"
#include "io/h5/h5_read.hpp"

namespace tetwarp::fclib {
namespace {
/// The names that are read in a group.
using Known = std::map<std::string, std::vector<std::string>>;

Known known_names(bool is_local) {
  const std::string root = is_local ? "fclib_local" : "fclib_global";
  Known known{{root, {"spacedim", "vectors", "info"}},
              {root + "/info", {"title", "description", "math_info"}},
              {"adhesion", {}},
              {"friction", {"second"}},
              {"guesses", {"number_of_guesses"}},
              {"solution",
               {"r", "u", "v", "l", "m", "residual_history", "contact_mode", "contact_residual"}},
              {"adhesion_next", {"intensity", "gap"}}};
  for (const AdhesionVector& vector : adhesion_vectors) {
    known["adhesion"].emplace_back(vector.name);
  }
  if (is_local) {
    known[root].insert(known[root].end(), {"W", "V", "R"});
    known[root + "/vectors"] = {"q", "mu"};
    return known;
  }
  known[root].insert(known[root].end(), {"M", "H", "G"});
  known[root + "/vectors"] = {"f", "w", "mu", "b"};
  known["bilateral"] = {"compliance", "group_ptr"};
  known["rolling"] = {"contact", "H", "rolling", "torsion"};
  known["blocks"] = {"block_ptr"};
  return known;
}
}  // namespace

std::vector<std::string> left_out(const h5::Object& file) {
  Known known = known_names(h5::is_group(file, "fclib_local"));
  if (h5::is_group(file, "guesses")) {
    const h5::Object guesses = h5::open_group(file, "guesses");
    for (int g = 1; h5::is_group(guesses, std::to_string(g)); ++g) {
      known["guesses"].push_back(std::to_string(g));
      known["guesses/" + std::to_string(g)] = {"r", "u", "l", "m"};
    }
  }
  for (const auto& [group, names] : Known(known)) {
    if (group.find('/') == std::string::npos) known[""].push_back(group);
  }
  std::vector<std::string> paths;
  for (const auto& [group, names] : known) {
    const std::size_t slash = group.find('/');
    const bool is_there =
        group.empty() || (h5::is_group(file, group.substr(0, slash)) &&
                          (slash == std::string::npos || h5::is_group(file, group)));
    if (!is_there) continue;
    const std::vector<std::string> children =
        group.empty() ? h5::child_names(file) : h5::child_names(h5::open_group(file, group));
    for (const std::string& name : children) {
      if (std::ranges::find(names, name) != names.end()) continue;
      paths.push_back(group.empty() ? name : group + "/" + name);
    }
  }
  return paths;
}

}  // namespace tetwarp::fclib
