/// @file tracked_names.cpp
/// Names by their signs.
#include "host/view/devices/tracked_names.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace tetwarp::view {
namespace {
constexpr int most_port = 65535, most_sensor = 9999;

/// Of digits alone.
std::optional<int> number_of(std::string_view text, int most) {
  int number = 0;
  const char* const end = text.data() + text.size();
  const auto [past, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || past != end || number < 0 || number > most) return std::nullopt;
  return number;
}

bool is_of_host(char letter) {
  return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
         (letter >= '0' && letter <= '9') || letter == '.' || letter == '-';
}

/// The parts before and after a sign, which is in the latter.
std::pair<std::string_view, std::string_view> split(std::string_view text, char sign) {
  const std::size_t at = std::min(text.find(sign), text.size());
  return {text.substr(0, at), text.substr(at)};
}

bool is_device(std::string_view text) {
  const auto [name, place] = split(text, '@');
  if (name.empty() || place.empty() || name.find_first_of(":/") != name.npos) return false;
  const auto [host, port] = split(place.substr(1), ':');
  const bool has_port = port.empty() || number_of(port.substr(1), most_port).value_or(0) > 0;
  return has_port && !host.empty() && std::ranges::all_of(host, is_of_host);
}
}  // namespace

TrackedNames tracked_names(const std::string& name) {
  const auto [first, second] = split(name, '+');
  const auto [tracker, hash] = split(first, '#');
  const std::string_view buttons = second.empty() ? tracker : second.substr(1);
  const auto sensor = hash.empty() ? 0 : number_of(hash.substr(1), most_sensor);
  if (!sensor || !is_device(tracker) || !is_device(buttons)) {
    throw std::invalid_argument("tracker '" + name +
                                "': expected TRACKER@HOST[:PORT][#SENSOR][+BUTTONS@HOST[:PORT]], "
                                "ports 1 to 65535, sensors 0 to 9999");
  }
  return {std::string(tracker), std::string(buttons), *sensor};
}

}  // namespace tetwarp::view
