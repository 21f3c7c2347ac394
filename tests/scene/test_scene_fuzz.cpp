/// @file test_scene_fuzz.cpp
/// Damaged scene files: a scene that passes the checks, or an error of one line.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/io/fuzz_bytes.hpp"
#include "tests/scene/scene_texts.hpp"

namespace tetwarp::test {
namespace {
using Json = nlohmann::ordered_json;

/// full_scene without its phantom, which takes time to make.
std::string text_without_volume() {
  Json scene = Json::parse(full_scene);
  std::erase_if(scene["bodies"].get_ref<Json::array_t&>(),
                [](const Json& body) { return body.contains("volume"); });
  return scene.dump(1);
}

struct Counts {
  int read = 0, refused = 0;
};

void try_text(const std::string& text, Counts& counts) {
  if (text.find("phantom") != std::string::npos) return;
  try {
    const Scene scene = parse_scene(text, "fuzz.json");
    ++counts.read;
    EXPECT_NO_THROW(check_scene(scene)) << text;
  } catch (const IoError& error) {
    ++counts.refused;
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_LT(message.size(), 600u) << message;
    EXPECT_TRUE(message.starts_with("fuzz.json: ")) << message;
  } catch (const std::exception& error) {
    ADD_FAILURE() << error.what() << "\nis no IoError, from\n" << text;
  }
}

/// All values of a document, objects and lists included.
void collect(Json& json, std::vector<Json*>& values) {
  values.push_back(&json);
  if (json.is_structured()) {
    for (Json& child : json) collect(child, values);
  }
}

TEST(SceneFuzz, BytesAndNumbers) {
  const std::string text = text_without_volume();
  Counts counts;
  for (std::uint64_t n = 0; n < 1500; ++n) {
    Random random(1, n);
    std::string damaged = n % 2 == 0 ? text : small_scene;
    if (n % 3 == 0) {
      damage_bytes(damaged, random);
    } else {
      damage_numbers(damaged, random);
    }
    try_text(damaged, counts);
  }
  EXPECT_GT(counts.read, 50);
  EXPECT_GT(counts.refused, 500);
}

TEST(SceneFuzz, Truncation) {
  const std::string text = text_without_volume();
  Counts counts;
  for (std::size_t length = 0; length < text.size(); length += 11) {
    try_text(text.substr(0, length), counts);
  }
  EXPECT_EQ(counts.read, 0);
}

TEST(SceneFuzz, ValuesOfOtherTypesAndMissingValues) {
  const Json original = Json::parse(text_without_volume());
  const Json others[] = {nullptr, true,           "all",          "",        -1,   0,     1e300,
                         0.5,     Json::array(),  Json::object(), {1, 2, 3}, 1e18, "x/y", {{1, 2}},
                         3,       {{"file", "x"}}};
  Counts counts;
  for (std::uint64_t n = 0; n < 1500; ++n) {
    Random random(2, n);
    Json damaged = original;
    for (std::size_t change = random.below(2) + 1; change > 0; --change) {
      std::vector<Json*> values;
      collect(damaged, values);
      Json& value = *values[random.below(values.size())];
      switch (random.below(4)) {
        case 0:  // removes or repeats an item
          if (value.is_structured() && !value.empty()) {
            auto item = value.begin();
            std::advance(item, static_cast<std::ptrdiff_t>(random.below(value.size())));
            if (value.is_array() && random.below(2) == 0) {
              value.push_back(Json(*item));
            } else {
              value.erase(item);
            }
          }
          break;
        case 1: {  // a part of the scene where another belongs
          const Json other = *values[random.below(values.size())];
          value = other;
          break;
        }
        default:
          value = others[random.below(std::size(others))];
      }
    }
    try_text(damaged.dump(), counts);
  }
  EXPECT_GT(counts.refused, 800);
}

TEST(SceneFuzz, DeepNestingIsRefused) {
  Counts counts;
  const std::string deep(100'000, '[');
  try_text(deep, counts);
  try_text(deep + std::string(100'000, ']'), counts);
  try_text(with(small_scene, "1000", deep + std::string(100'000, ']')), counts);
  EXPECT_EQ(counts.refused, 3);
}
}  // namespace
}  // namespace tetwarp::test
