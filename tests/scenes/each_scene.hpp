/// @file each_scene.hpp
/// Suites over the adversarial scenes. Their parameter is a scene's number: a test makes the scene
/// it needs, and starting a program, which ctest does once per test, makes none.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tests/scenes/scenes.hpp"

namespace tetwarp::test {

/// Numbers of the scenes of these names, or of all.
inline std::vector<std::size_t> scene_numbers(std::initializer_list<std::string_view> names = {}) {
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < scenes::adversarial_names.size(); ++i) {
    const bool is_named =
        std::find(names.begin(), names.end(), scenes::adversarial_names[i]) != names.end();
    if (names.size() == 0 || is_named) numbers.push_back(i);
  }
  return numbers;
}

/// A scene of about n^3 voxels.
template <std::int64_t n>
class EachScene : public ::testing::TestWithParam<std::size_t> {
 protected:
  const scenes::Scene& scene() {
    if (!scene_) scene_ = scenes::adversarial_scenes(n).at(GetParam());
    return *scene_;
  }

 private:
  std::optional<scenes::Scene> scene_;
};

/// slivers
inline std::string scene_name(const ::testing::TestParamInfo<std::size_t>& info) {
  return std::string(scenes::adversarial_names[info.param]);
}

/// slivers_8, unique among all scenes.
inline std::string numbered_scene_name(const ::testing::TestParamInfo<std::size_t>& info) {
  return scene_name(info) + "_" + std::to_string(info.param);
}

}  // namespace tetwarp::test
