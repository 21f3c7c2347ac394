/// @file json_names.hpp
/// The names in a JSON object.
#pragma once
#include <nlohmann/json.hpp>
#include <set>
#include <string>

namespace tetwarp::test {

inline std::set<std::string> names_of(const nlohmann::json& object) {
  std::set<std::string> names;
  for (const auto& item : object.items()) names.insert(item.key());
  return names;
}

}  // namespace tetwarp::test
