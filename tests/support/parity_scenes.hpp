/// @file parity_scenes.hpp
/// Small scenes with a bit of everything, different for every seed, for comparing steppers.
#pragma once
#include <string>
#include <vector>

#include <tetwarp/scene.hpp>

namespace tetwarp::test {

struct NamedScene {
  const char* name;
  Scene (*make)(std::uint64_t seed);
};

/// Scenes of up to a hundred nodes.
const std::vector<NamedScene>& parity_scenes();

}  // namespace tetwarp::test
