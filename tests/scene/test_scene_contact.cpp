/// @file test_scene_contact.cpp
/// Contact in scene files: what is inherited, overridden and removed; mistakes; damaged files.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/io/fuzz_bytes.hpp"
#include "tests/scene/scene_texts.hpp"

namespace tetwarp::test {
namespace {
using Json = nlohmann::ordered_json;

/// A scene of two bodies and two obstacles in which everything about contact stands.
constexpr const char* contact_scene = R"({
  "tetwarp_scene": 1, "time_step": 0.01, "duration": 1, "thickness": 1e-4,
  "contact": {"friction": 0.5, "adhesion": {"stiffness": 1e6, "energy": 3},
    "pairs": [
      {"a": "cup", "b": "cloth", "friction": 0.25,
        "adhesion": {"stiffness": 2e6, "energy": 4, "initial_intensity": 1}},
      {"a": "bar", "b": "cup", "adhesion": null},
      {"a": "cloth", "b": "cloth", "friction": 0.125},
      {"a": "floor", "b": "cup", "collide": false}]},
  "bodies": [
    {"name": "cup", "kind": "rigid", "density": 1000, "self": false,
      "shape": {"type": "sphere", "radius": 0.1}, "contact": {"friction": 0.75}},
    {"name": "cloth", "kind": "cloth", "areal_density": 0.3, "stretch": 400, "self": false,
      "sheet": {"size": [1, 1], "cells": [2, 2]}, "contact": {"adhesion": null}}],
  "obstacles": [
    {"name": "floor", "plane": {"normal": [0, 0, 1]}, "contact": {"friction": 0}},
    {"name": "bar", "capsule": {"from": [0, 0, 0], "to": [1, 0, 0], "radius": 0.1}}],
  "solver": {"contact_tolerance": 1e-6, "max_passes": 7, "max_substeps": 8},
  "output": {"fields": ["contact"]}})";

TEST(SceneContact, OfBodiesIsThatOfTheSceneButForTheirOwnKeys) {
  const Scene scene = scene_of(contact_scene);

  EXPECT_EQ(scene.thickness, 1e-4);
  const SurfaceContact& cup = scene.bodies[0].contact.value();
  EXPECT_EQ(cup.friction, 0.75);
  EXPECT_EQ(cup.adhesion.value().energy, 3) << "inherited";
  const SurfaceContact& cloth = scene.bodies[1].contact.value();
  EXPECT_EQ(cloth.friction, 0.5) << "inherited";
  EXPECT_FALSE(cloth.adhesion) << "null removes it";
  EXPECT_EQ(scene.bodies[1].self, false);
  EXPECT_EQ(scene.obstacles[0].contact.value().friction, 0);
  EXPECT_EQ(scene.obstacles[0].contact.value().adhesion.value().stiffness, 1e6);
  EXPECT_FALSE(scene.obstacles[1].contact) << "all of it is that of the scene";
  EXPECT_EQ(scene.output.fields, std::vector<std::string>{"contact"});
}

TEST(SceneContact, OfPairsKeepsApartWhatIsGivenAndWhatIsNot) {
  const Scene scene = scene_of(contact_scene);

  const std::vector<ContactPairMaterial>& pairs = scene.contact.pairs;
  ASSERT_EQ(pairs.size(), 4u);
  EXPECT_EQ(pairs[0].friction, 0.25);
  EXPECT_TRUE(pairs[0].has_adhesion);
  EXPECT_EQ(pairs[0].adhesion.value().energy, 4);
  EXPECT_EQ(pairs[0].adhesion.value().initial_intensity, 1);
  EXPECT_FALSE(pairs[0].adhesion.value().tangential_stiffness) << "as the stiffness";
  EXPECT_FALSE(pairs[1].friction);
  EXPECT_TRUE(pairs[1].has_adhesion && !pairs[1].adhesion) << "null removes it";
  EXPECT_EQ(pairs[2].a + pairs[2].b, "clothcloth");
  EXPECT_FALSE(pairs[2].has_adhesion);
  EXPECT_TRUE(pairs[2].collide);
  EXPECT_FALSE(pairs[3].collide);
}

struct ContactSlip {
  const char* part;     ///< of contact_scene
  const char* by;       ///< what stands there instead
  const char* message;  ///< its beginning
};
const ContactSlip contact_slips[] = {
    {"\"friction\": 0.5", "\"friction\": -1", "contact.friction: is -1, expected a number from 0"},
    {"\"friction\": 0.5", "\"friction\": true", "contact.friction: is true, expected a number"},
    {"\"friction\": 0.5", "\"frction\": 1", "contact.frction: is no known key; did you mean"},
    {"{\"stiffness\": 1e6, \"energy\": 3}", "3",
     "contact.adhesion: is the number 3, expected an object {...}, or null for none"},
    {"\"stiffness\": 1e6", "\"stiffness\": 0",
     "contact.adhesion.stiffness: is 0, expected a number above 0 (N/m^3)"},
    {"\"energy\": 3", "\"energy\": -3",
     "contact.adhesion.energy: is -3, expected a number from 0 (J/m^2)"},
    {", \"energy\": 3", "", "contact.adhesion.energy: is missing, expected a number from 0"},
    {"\"energy\": 3", "\"energy\": 3, \"tangential_stiffness\": -1",
     "contact.adhesion.tangential_stiffness: is -1, expected a number from 0 (N/m^3)"},
    {"\"energy\": 3", "\"energy\": 3, \"viscosity\": -1",
     "contact.adhesion.viscosity: is -1, expected a number from 0 (J s/m^2)"},
    {"\"energy\": 3", "\"energy\": 3, \"bonding_rate\": -1",
     "contact.adhesion.bonding_rate: is -1, expected a number from 0 (1/(Pa s))"},
    {"\"energy\": 3", "\"energy\": 3, \"saturation_pressure\": -1",
     "contact.adhesion.saturation_pressure: is -1, expected a number from 0 (Pa)"},
    {"\"energy\": 3", "\"energy\": 3, \"initial_intensity\": 1.001",
     "contact.adhesion.initial_intensity: is 1.001, expected 0 to 1"},
    {"\"energy\": 3", "\"energy\": 3, \"cohesion\": 1",
     "contact.adhesion.cohesion: is no known key; the keys here are bonding_rate, energy"},
    {"\"energy\": 4", "\"energy\": -4",
     "contact.pairs[0].adhesion.energy: is -4, expected a number from 0 (J/m^2)"},
    {"\"friction\": 0.25", "\"friction\": -0.25",
     "contact.pairs[0].friction: is -0.25, expected a number from 0"},
    {"\"a\": \"cup\", \"b\": \"cloth\"", "\"b\": \"cloth\"",
     "contact.pairs[0].a: is missing, expected the name of a body or obstacle"},
    {"\"a\": \"cup\", \"b\": \"cloth\"", "\"a\": \"cup\", \"b\": \"world\"",
     "contact.pairs[0].b: there is no body or obstacle 'world', expected one of"},
    {"\"a\": \"bar\"", "\"a\": \"cloth\"",
     "contact.pairs[1]: 'cloth' and 'cup' are a pair twice; keep one"},
    {"\"collide\": false", "\"collide\": null",
     "contact.pairs[3].collide: is null, expected true or false"},
    {"\"collide\": false", "\"collides\": false",
     "contact.pairs[3].collides: is no known key; did you mean 'collide'?"},
    {"{\"friction\": 0.75}", "{\"friction\": -0.75}",
     "bodies[0].contact.friction: is -0.75, expected a number from 0"},
    {"{\"friction\": 0.75}", "{\"pairs\": []}",
     "bodies[0].contact.pairs: is no known key; the keys here are adhesion, friction"},
    {"{\"friction\": 0.75}", "null", "bodies[0].contact: is null, expected an object {...}"},
    {"1000, \"self\": false", "1000, \"self\": true", "bodies[0].self: is not for rigid bodies"},
    {"\"contact\": {\"friction\": 0}", "\"contact\": {\"adhesion\": {}}",
     "obstacles[0].contact.adhesion.stiffness: is missing, expected a number above 0"},
    {"\"thickness\": 1e-4", "\"thickness\": -1", "thickness: is -1, expected a number above 0"},
    {"\"thickness\": 1e-4", "\"thickness\": null", "thickness: is null, expected a number"},
    {"\"contact_tolerance\": 1e-6", "\"contact_tolerance\": 0",
     "solver.contact_tolerance: is 0, expected more than 0 and less than 1"},
    {"\"max_passes\": 7", "\"max_passes\": 0",
     "solver.max_passes: is the number 0, expected a whole number from 1"},
    {"\"max_substeps\": 8", "\"max_substeps\": 1025",
     "solver.max_substeps: is 1025, expected 1 to 1024"},
    {"\"max_substeps\": 8", "\"rule\": \"serial\"", "solver.rule: is no known word, expected"},
    {"[\"contact\"]", "[\"contacts\"]", "output.fields[0]: is no field, expected velocity"}};

TEST(SceneContact, SlipsAreNamedInOneLine) {
  for (const ContactSlip& slip : contact_slips) {
    const std::string problem = problem_of(with(contact_scene, slip.part, slip.by));
    EXPECT_TRUE(problem.starts_with(slip.message))
        << slip.part << " -> " << slip.by << "\n  is:       " << problem
        << "\n  expected: " << slip.message;
    EXPECT_EQ(problem.find('\n'), std::string::npos);
  }
}

/// All values below the keys `contact`, `thickness` and `solver`.
void collect_contact(Json& json, bool is_inside, std::vector<Json*>& values) {
  if (is_inside) values.push_back(&json);
  if (!json.is_structured()) return;
  for (auto item = json.begin(); item != json.end(); ++item) {
    const std::string key = json.is_object() ? item.key() : "";
    collect_contact(*item, is_inside || key == "contact" || key == "thickness" || key == "solver",
                    values);
  }
}

/// A damaged scene is one that passes the checks, or an error of one line with the key's path.
TEST(SceneContact, DamagedKeysAreReadOrRefused) {
  const Json contact_others[] = {nullptr,
                                 true,
                                 "all",
                                 "cup",
                                 -1,
                                 0,
                                 1,
                                 0.5,
                                 1e300,
                                 1e-300,
                                 Json::array(),
                                 Json::object(),
                                 Json::parse(R"({"stiffness": 1, "energy": 2})"),
                                 Json::parse(R"({"a": "cup", "b": "bar"})")};
  int read = 0, refused = 0;
  for (std::uint64_t n = 0; n < 2000; ++n) {
    Random random(7, n);
    Json scene = Json::parse(contact_scene);
    for (std::uint64_t changes = random.below(3) + 1; changes > 0; --changes) {
      std::vector<Json*> values;
      collect_contact(scene, false, values);
      Json& value = *values[random.below(values.size())];
      const Json other = random.below(3) == 0
                             ? Json(*values[random.below(values.size())])
                             : contact_others[random.below(std::size(contact_others))];
      value = other;
    }
    std::string text = scene.dump();
    if (n % 4 == 0) damage_numbers(text, random);
    try {
      const Scene checked = parse_scene(text, "fuzz.json");
      EXPECT_NO_THROW(check_scene(checked)) << text;
      ++read;
    } catch (const IoError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      EXPECT_TRUE(message.starts_with("fuzz.json: ")) << message;
      EXPECT_LT(message.size(), 600u) << message;
      ++refused;
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what() << "\nis no IoError, from\n" << text;
    }
  }
  EXPECT_GT(read, 100);
  EXPECT_GT(refused, 800);
}
}  // namespace
}  // namespace tetwarp::test
