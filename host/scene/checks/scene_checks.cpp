/// @file scene_checks.cpp
/// Checks of single numbers, vectors and names.
#include "host/scene/checks/scene_checks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace tetwarp {
namespace {
constexpr std::size_t longest_name = 100;

std::string with_unit(const std::string& text, const char* unit) {
  return *unit == '\0' ? text : text + " (" + unit + ")";
}

bool is_name_character(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-';
}
}  // namespace

void fail_at(const std::string& place, const std::string& problem) {
  throw std::invalid_argument(place + ": " + problem);
}

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

void check_finite(const std::string& place, double value) {
  if (!std::isfinite(value)) fail_at(place, "is not finite, expected a number");
}

void check_finite(const std::string& place, const Point3& value) {
  for (const double component : value) check_finite(place, component);
}

void check_positive(const std::string& place, double value, const char* unit) {
  if (value > 0 && std::isfinite(value)) return;
  fail_at(place, "is " + number_text(value) + ", expected " + with_unit("a number above 0", unit));
}

void check_not_negative(const std::string& place, double value, const char* unit) {
  if (value >= 0 && std::isfinite(value)) return;
  fail_at(place, "is " + number_text(value) + ", expected " + with_unit("a number from 0", unit));
}

void check_range(const std::string& place, double value, double low, double high) {
  if (value >= low && value <= high) return;
  fail_at(place, "is " + number_text(value) + ", expected " + number_text(low) + " to " +
                     number_text(high));
}

void check_direction(const std::string& place, const Point3& value) {
  check_finite(place, value);
  const double length = std::hypot(value[0], value[1], value[2]);
  if (!(length > 0) || !std::isfinite(length)) {
    fail_at(place, "has length " + number_text(length) + ", expected a vector with a direction");
  }
}

void check_name(const std::string& place, const std::string& name) {
  if (name.empty() || name.size() > longest_name ||
      !std::all_of(name.begin(), name.end(), is_name_character)) {
    fail_at(place, "is no name: use 1 to " + std::to_string(longest_name) +
                       " of the characters A-Z, a-z, 0-9, '_' and '-'");
  }
  if (name == "world") fail_at(place, "'world' names the fixed world; choose another name");
}

void check_unit_quaternion(const std::string& place, const std::array<double, 4>& quaternion) {
  double sum = 0;
  for (const double component : quaternion) {
    check_finite(place, component);
    sum += component * component;
  }
  if (std::abs(sum - 1) > 1e-6) {
    fail_at(place, "has length " + number_text(std::sqrt(sum)) + ", expected 1");
  }
}

}  // namespace tetwarp
