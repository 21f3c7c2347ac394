/// @file each_scene.hpp
/// Suites over the adversarial scenes. Their parameter is a scene's name: a test makes the scene it
/// needs, and starting a program, which ctest does once per test, makes none.
#pragma once
#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/scenes.hpp"

namespace tetwarp::test {

using SceneNames = std::vector<std::string>;

inline SceneNames all_scene_names() {
  return {scenes::adversarial_names.begin(), scenes::adversarial_names.end()};
}

/// A scene of about n^3 voxels.
template <std::int64_t n>
class EachScene : public ::testing::TestWithParam<std::string> {
 protected:
  const scenes::Scene& scene() {
    if (!scene_) scene_ = scenes::adversarial_scene(GetParam(), n);
    return *scene_;
  }

 private:
  std::optional<scenes::Scene> scene_;
};

inline std::string scene_name(const ::testing::TestParamInfo<std::string>& info) {
  return info.param;
}

}  // namespace tetwarp::test
