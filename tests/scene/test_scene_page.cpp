/// @file test_scene_page.cpp
/// docs/scenes.md: its example is a scene, and it names every key.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "tests/scene/scene_texts.hpp"

namespace tetwarp::test {
namespace {
/// Empty where the sources are not at hand.
std::string page() {
  std::ifstream file(TETWARP_SCENE_PAGE);
  return {std::istreambuf_iterator<char>(file), {}};
}

void collect_keys(const nlohmann::json& json, std::set<std::string>& keys) {
  for (const auto& [key, value] : json.items()) {
    if (json.is_object()) keys.insert(key);
    if (value.is_structured()) collect_keys(value, keys);
  }
}

TEST(ScenePage, HasAnExampleThatIsAScene) {
  const std::string text = page();
  if (text.empty()) GTEST_SKIP() << "no sources at " << TETWARP_SCENE_PAGE;
  const std::size_t begin = text.find("```json\n") + 8;
  const Scene scene = scene_of(text.substr(begin, text.find("```", begin) - begin));
  EXPECT_EQ(scene.bodies.at(0).name, "beam");
  EXPECT_EQ(scene.handles.at(0).path.size(), 3u);
}

TEST(ScenePage, NamesEveryKey) {
  const std::string text = page();
  if (text.empty()) GTEST_SKIP() << "no sources at " << TETWARP_SCENE_PAGE;
  std::set<std::string> keys;
  collect_keys(nlohmann::json::parse(full_scene), keys);
  for (const std::string& key : keys) {
    const bool is_named = text.find('`' + key + '`') != std::string::npos ||
                          text.find('"' + key + '"') != std::string::npos;
    EXPECT_TRUE(is_named) << key;
  }
}
}  // namespace
}  // namespace tetwarp::test
