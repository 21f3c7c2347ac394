/// @file value_names.cpp
/// Writes and parses the text "value name" line by line.
#include "io/h5/value_names.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>

#include "io/h5/h5_attribute.hpp"
#include "io/h5/h5_write.hpp"

namespace tetwarp {
namespace {
const std::string attribute = "tetwarp_value_names";
}  // namespace

std::string text_of_names(const std::map<std::int64_t, std::string>& names) {
  std::string text;
  for (const auto& [value, name] : names) {
    std::string line = std::to_string(value) + " " + name;
    std::ranges::replace_if(
        line, [](char c) { return c == '\n' || c == '\r' || c == '\0'; }, ' ');
    text += (text.empty() ? "" : "\n") + line;
  }
  return text;
}

void write_value_names(const h5::Object& dataset,
                       const std::map<std::int64_t, std::string>& names) {
  if (names.empty()) return;
  const std::string text = text_of_names(names);
  if (text.size() > max_value_names) {
    dataset.fail("the names of its values take " + std::to_string(text.size()) +
                 " bytes, expected at most " + std::to_string(max_value_names));
  }
  h5::write_text_attribute(dataset, attribute, text);
}

std::map<std::int64_t, std::string> read_value_names(const h5::Object& dataset) {
  std::map<std::int64_t, std::string> names;
  if (!h5::has_attribute(dataset, attribute)) return names;
  std::istringstream text(h5::read_text_attribute(dataset, attribute));
  for (std::string line; std::getline(text, line);) {
    std::int64_t value = 0;
    const char* const end = line.data() + line.size();
    const auto [rest, error] = std::from_chars(line.data(), end, value);
    if (error != std::errc() || rest == end || *rest != ' ') {
      dataset.fail("attribute " + attribute + " has the line '" + line +
                   "', expected a number, a space and a name");
    }
    names[value] = std::string(rest + 1, end);
  }
  return names;
}

}  // namespace tetwarp
