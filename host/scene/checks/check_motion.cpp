/// @file check_motion.cpp
/// Checks of paths, hinges, waves and selections.
#include "host/scene/checks/check_motion.hpp"

#include <cmath>
#include <type_traits>
#include <variant>

#include "host/scene/checks/scene_checks.hpp"

namespace tetwarp {
namespace {
/// @param before  time of the entry before, if there is one
void check_time(const std::string& place, double time, const double* before) {
  check_finite(place, time);
  if (before != nullptr && !(time > *before)) {
    fail_at(place, "time " + number_text(time) + " s is not after " + number_text(*before) +
                       " s; sort the list by time");
  }
}

void check_hinge(const std::string& place, const Hinge& hinge) {
  check_finite(key_of(place, "point"), hinge.point);
  check_direction(key_of(place, "axis"), hinge.axis);
  const std::string angles = key_of(place, "angle");
  if (hinge.angle.empty()) fail_at(angles, "is empty, expected [[time, angle], ...]");
  for (std::size_t n = 0; n < hinge.angle.size(); ++n) {
    check_time(item_of(angles, n), hinge.angle[n][0], n == 0 ? nullptr : &hinge.angle[n - 1][0]);
    check_finite(item_of(angles, n), hinge.angle[n][1]);
  }
}

void check_wave(const std::string& place, const Wave& wave) {
  check_range(key_of(place, "axis"), wave.axis, 0, 2);
  check_range(key_of(place, "lateral"), wave.lateral, 0, 2);
  if (wave.axis == wave.lateral) {
    fail_at(key_of(place, "lateral"), "equals axis, expected another axis");
  }
  check_not_negative(key_of(place, "frequency"), wave.frequency, "1/s");
  check_positive(key_of(place, "wavelength"), wave.wavelength, "lengths of the body");
  check_finite(key_of(place, "phase"), wave.phase);
  for (const double factor : wave.envelope) check_finite(key_of(place, "envelope"), factor);
}

void check_part(const std::string& place, const BoxSelection& box) {
  const std::string key = key_of(place, "box");
  check_finite(key, box.low);
  check_finite(key, box.high);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (box.low[axis] > box.high[axis]) {
      fail_at(key, "its first corner lies beyond its second one, swap them");
    }
  }
}

void check_part(const std::string& place, const SphereSelection& sphere) {
  check_finite(key_of(place, "sphere"), sphere.center);
  check_positive(key_of(place, "sphere"), sphere.radius, "radius, m");
}

void check_part(const std::string& place, const HalfSpaceSelection& half) {
  check_direction(key_of(place, "half_space"), half.normal);
  check_finite(key_of(place, "half_space"), half.offset);
}

void check_part(const std::string& place, const LabelSelection& label) {
  check_finite(key_of(place, "label"), label.value);
}

void check_part(const std::string& place, const NodeSelection& some) {
  const std::string key = key_of(place, "nodes");
  if (some.nodes.empty()) fail_at(key, "is empty, expected numbers of nodes");
  for (std::size_t n = 0; n < some.nodes.size(); ++n) {
    if (some.nodes[n] < 0) fail_at(item_of(key, n), "is negative, nodes count from 0");
  }
}

void check_part(const std::string&, const AllSelection&) {}
}  // namespace

void check_path(const std::string& place, const Path& path, bool may_release) {
  for (std::size_t n = 0; n < path.size(); ++n) {
    const std::string item = item_of(place, n);
    check_time(item, path[n].time, n == 0 ? nullptr : &path[n - 1].time);
    check_finite(item, path[n].axis_angle);
    if (path[n].displacement) {
      check_finite(item, *path[n].displacement);
    } else if (!may_release) {
      fail_at(item, "is null, which only the last point of a handle's path may be; give x, y, z");
    } else if (n + 1 < path.size()) {
      fail_at(item, "lets go before the end of the path; remove what follows");
    } else if (n == 0) {
      fail_at(item, "lets go from the start; give a point before it");
    }
  }
}

void check_motion(const std::string& place, const Motion& motion) {
  if (const auto* path = std::get_if<Path>(&motion)) {
    if (path->empty()) fail_at(key_of(place, "path"), "is empty, expected [[t, x, y, z], ...]");
    check_path(key_of(place, "path"), *path, false);
  } else if (const auto* hinge = std::get_if<Hinge>(&motion)) {
    check_hinge(key_of(place, "hinge"), *hinge);
  } else if (const auto* wave = std::get_if<Wave>(&motion)) {
    check_wave(key_of(place, "wave"), *wave);
  }
}

void check_selection(const std::string& place, const Selection& select, const Body& body) {
  if (select.empty()) fail_at(place, "is missing or empty, expected a selection, e.g. \"all\"");
  if (std::holds_alternative<std::monostate>(body.geometry)) {
    fail_at(place, "'" + body.name + "' has no geometry to select from; give it one");
  }
  for (std::size_t n = 0; n < select.size(); ++n) {
    const std::string part_place = select.size() == 1 ? place : item_of(place, n);
    if (std::holds_alternative<LabelSelection>(select[n]) &&
        !std::holds_alternative<ImageGeometry>(body.geometry)) {
      fail_at(key_of(part_place, "label"),
              "'" + body.name + "' is not made of a volume, select by box, sphere or nodes");
    }
    std::visit([&](const auto& part) { check_part(part_place, part); }, select[n]);
  }
}

}  // namespace tetwarp
