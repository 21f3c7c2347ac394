/// @file number_line.cpp
/// Words that are numbers to their end.
#include "host/view/devices/number_line.hpp"

#include <charconv>
#include <cmath>
#include <sstream>

namespace tetwarp::view {

std::optional<std::vector<double>> numbers_of(const std::string& line) {
  std::istringstream words(line);
  std::vector<double> numbers;
  for (std::string word; words >> word;) {
    const char* const end = word.data() + word.size();
    const bool has_plus = word.starts_with('+') && !word.starts_with("+-");
    double& number = numbers.emplace_back();
    const auto [past, error] = std::from_chars(word.data() + (has_plus ? 1 : 0), end, number);
    if (error != std::errc() || past != end || !std::isfinite(number)) return std::nullopt;
  }
  return numbers;
}

}  // namespace tetwarp::view
