/// @file json_text.hpp
/// JSON as text.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace tetwarp::cli {

/// The text of a value. Names of files may be any bytes: those that are no UTF-8 become U+FFFD.
/// @param indent  spaces per level; -1: one line
template <class Json>
std::string json_text(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace tetwarp::cli
