/// @file scene_checks.hpp
/// Checks of single numbers, vectors and names of a scene. Each throws std::invalid_argument in one
/// line: the place as a scene file spells it, the problem and the remedy.
#pragma once
#include <map>
#include <string>
#include <vector>

#include <tetwarp/scene.hpp>

#include "host/base/scene_path.hpp"

namespace tetwarp {

/// Bodies and obstacles by name; nullptr for obstacles.
using SceneNames = std::map<std::string, const Body*>;

[[noreturn]] void fail_at(const std::string& place, const std::string& problem);

/// A number as text, at most 6 digits.
std::string number_text(double value);
void check_finite(const std::string& place, double value);
void check_finite(const std::string& place, const Point3& value);

/// @param unit  for the message, may be empty
void check_positive(const std::string& place, double value, const char* unit);
void check_not_negative(const std::string& place, double value, const char* unit);
void check_range(const std::string& place, double value, double low, double high);

/// A vector that has a direction.
void check_direction(const std::string& place, const Point3& value);

/// Letters, digits, '_' and '-', at most 100 of them, and not "world".
void check_name(const std::string& place, const std::string& name);
void check_unit_quaternion(const std::string& place, const std::array<double, 4>& quaternion);

}  // namespace tetwarp
