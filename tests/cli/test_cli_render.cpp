/// @file test_cli_render.cpp
/// `tetwarp render`: rays, films, and what is refused.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/support/cli_scene.hpp"

namespace tetwarp::test {
namespace {
using Words = std::vector<std::string>;

void write_ramp(const TemporaryFolder& folder, const std::string& name, float factor = 1) {
  Volume volume = ramp_volume<float>();
  for (float& sample : volume.samples<float>()) sample *= factor;
  write_volumes(folder / name, {&volume});
}

TEST(RenderCommand, CastsByThePresetsOrAFile) {
  const TemporaryFolder folder;
  write_ramp(folder, "a.vtkhdf");
  write_text(folder / "clear.json",
             R"({"points": [{"value": 0, "color": [1, 0, 0], "opacity": 0}]})");
  write_text(folder / "red.json",
             R"({"length": 0.001, "points": [{"value": 0, "color": [1, 0, 0], "opacity": 1}]})");
  std::vector<std::string> pictures;
  for (const char* const colors : {"ct", "mr", "clear.json", "red.json"}) {
    const CommandResult result = run_command(
        folder, {"render", "a.vtkhdf", "--cast", colors, "-o", "a.png", "--pixels", "40,30"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out, "40 x 30 pixels: a.png\n");
    pictures.push_back(text_of(folder / "a.png"));
  }
  for (std::size_t a = 0; a < pictures.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) EXPECT_NE(pictures[a], pictures[b]) << a << ' ' << b;
  }
}

/// All pictures of a film have the window of the first, so that a darker volume looks darker.
TEST(RenderCommand, MakesFilmsOfVolumes) {
  const TemporaryFolder folder;
  write_ramp(folder, "a.vtkhdf");
  write_ramp(folder, "b.vtkhdf", 0.5);

  const CommandResult slices =
      run_command(folder, {"render", "a.vtkhdf", "b.vtkhdf", "-o", "s.gif", "--height", "20"});

  if (slices.err.find("libgif-dev") != std::string::npos) GTEST_SKIP() << "needs libgif-dev";
  ASSERT_EQ(slices.exit_code, 0) << slices.err;
  EXPECT_TRUE(slices.out.starts_with("2 pictures of ")) << slices.out;
  const CommandResult same =
      run_command(folder, {"render", "a.vtkhdf", "a.vtkhdf", "-o", "t.gif", "--height", "20"});
  ASSERT_EQ(same.exit_code, 0) << same.err;
  EXPECT_NE(text_of(folder / "s.gif"), text_of(folder / "t.gif"));
  const CommandResult rays = run_command(
      folder, {"render", "a.vtkhdf", "b.vtkhdf", "--cast", "-o", "r.gif", "--pixels", "20,20"});
  EXPECT_EQ(rays.out, "2 pictures of 20 x 20 pixels: r.gif\n") << rays.err;
}

/// The range of Hounsfield units has colors of its own, unless a window is given.
TEST(RenderCommand, CastsInTheWindowThatIsGiven) {
  const TemporaryFolder folder;
  Volume volume = ramp_volume<float>();
  for (float& sample : volume.samples<float>()) sample = 2 * sample - 1000;  // -998 to 920
  write_volumes(folder / "a.vtkhdf", {&volume});
  std::vector<std::string> pictures;
  for (const Words& window : {Words{}, Words{"--low", "-998"}, Words{"--high", "900"}}) {
    Words words{"render", "a.vtkhdf", "--cast", "-o", "a.png", "--pixels", "40,30"};
    words.insert(words.end(), window.begin(), window.end());
    const CommandResult result = run_command(folder, words);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    pictures.push_back(text_of(folder / "a.png"));
  }
  EXPECT_NE(pictures[0], pictures[1]);
  EXPECT_NE(pictures[0], pictures[2]);
}

TEST(RenderCommand, DrawsTheSameStepBeside) {
  const TemporaryFolder folder;
  const Volume up = ramp_volume<float>();
  Volume down = up;
  for (float& sample : down.samples<float>()) sample = 961 - sample;
  write_volumes(folder / "up.vtkhdf", {&up});
  write_volumes(folder / "down.vtkhdf", {&down});
  TemporalVolumeWriter writer(folder / "both.vtkhdf");
  writer.append(0, {&up});
  writer.append(1, {&down});
  writer.finish();
  const auto drawn = [&](const std::string& volume, const std::string& beside,
                         const std::string& output, const Words& more) {
    Words words{"render", volume, "--beside", beside, "-o", output, "--height", "20"};
    words.insert(words.end(), more.begin(), more.end());
    const CommandResult result = run_command(folder, words);
    EXPECT_TRUE(result.exit_code == 0 || output.ends_with(".gif")) << result.err;
    return result.exit_code == 0 ? text_of(folder / output) : result.err;
  };

  const std::string second = drawn("both.vtkhdf", "both.vtkhdf", "a.png", {"--step", "1"});
  EXPECT_EQ(second, drawn("down.vtkhdf", "down.vtkhdf", "b.png", {}));
  EXPECT_NE(second, drawn("down.vtkhdf", "up.vtkhdf", "c.png", {}));

  const std::string film = drawn("both.vtkhdf", "both.vtkhdf", "a.gif", {});
  if (film.find("libgif-dev") != std::string::npos) GTEST_SKIP() << "needs libgif-dev";
  EXPECT_NE(film, drawn("both.vtkhdf", "up.vtkhdf", "b.gif", {}));
}

TEST(RenderCommand, DrawsAVolumeOfOneValue) {
  const TemporaryFolder folder;
  write_ramp(folder, "flat.vtkhdf", 0);

  for (const Words& more : {Words{"--height", "20"}, Words{"--cast", "--pixels", "20,20"}}) {
    Words words{"render", "flat.vtkhdf", "-o", "flat.png"};
    words.insert(words.end(), more.begin(), more.end());
    EXPECT_EQ(run_command(folder, words).exit_code, 0);
  }
}

TEST(RenderCommand, NamesWhatIsWrongInOneLine) {
  const TemporaryFolder folder;
  write_ramp(folder, "a.vtkhdf");
  write_text(folder / "down.json",
             R"({"points": [{"value": 1, "color": [0, 0, 0], "opacity": 0},
                            {"value": 0, "color": [0, 0, 0], "opacity": 0}]})");
  write_text(folder / "opaque.json",
             R"({"points": [{"value": 1, "color": [0, 0, 0], "opaque": 0}]})");
  const std::vector<std::pair<Words, std::string>> cases{
      {{"a.vtkhdf", "a.vtkhdf", "-o", "x.png"}, "is a picture, of one volume"},
      {{"a.vtkhdf", "-o", "x.jpg"}, "that of a film in .gif"},
      {{"a.vtkhdf", "-o", "x.png", "--cast", "--beside", "a.vtkhdf"}, "--beside"},
      {{"a.vtkhdf", "-o", "x.png", "--camera", "0,0,0,1,1,1"}, "needs --cast"},
      {{"a.vtkhdf", "-o", "x.png", "--cast", "--camera", "1,1,1,1,1,1"}, "the same point"},
      {{"a.vtkhdf", "-o", "x.png", "--cast", "--camera", "inside"}, "only scenes have cameras"},
      {{"a.vtkhdf", "-o", "x.png", "--cast", "down.json"}, "points[1].value"},
      {{"a.vtkhdf", "-o", "x.png", "--cast", "opaque.json"}, "points[0]"},
      {{"a.vtkhdf", "-o", "x.png", "--cast", "none.json"}, "none.json"},
      {{"a.vtkhdf", "-o", "x.png", "--cast", "down.json", "--low", "1"}, "--low: the file"},
      {{"a.vtkhdf", "-o", "x.png", "--cast", "--low", "3", "--high", "3"}, "--low: is not below"},
      {{"a.vtkhdf", "-o", "x.png", "--cast", "--low", "1000"}, "from 1000 to 960"},
      {{"a.vtkhdf", "-o", "x.png", "--cast", "--height", "20"}, "--height: is of slices"},
      {{"a.vtkhdf", "-o", "x.png", "--pixels", "20,20"}, "--pixels: needs --cast"},
      {{"a.vtkhdf", "-o", "x.png", "--seconds", "1"}, "--seconds: is of a film"}};
  for (const auto& [options, named] : cases) {
    Words words{"render"};
    words.insert(words.end(), options.begin(), options.end());

    const CommandResult result = run_command(folder, words);

    EXPECT_NE(result.exit_code, 0) << named;
    EXPECT_TRUE(result.has_one_line_error()) << result.err;
    EXPECT_NE(result.err.find(named), std::string::npos) << result.err;
    EXPECT_FALSE(fs::exists(folder / "x.png")) << named;
  }
}

}  // namespace
}  // namespace tetwarp::test
