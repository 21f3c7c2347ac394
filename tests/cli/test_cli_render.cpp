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

TEST(RenderCommand, DrawsAVolumeOfOneValue) {
  const TemporaryFolder folder;
  write_ramp(folder, "flat.vtkhdf", 0);

  for (const Words& more : {Words{}, Words{"--cast"}}) {
    Words words{"render", "flat.vtkhdf", "-o", "flat.png", "--height", "20"};
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
      {{"a.vtkhdf", "-o", "x.png", "--cast", "down.json"}, "points[1].value"},
      {{"a.vtkhdf", "-o", "x.png", "--cast", "opaque.json"}, "points[0]"},
      {{"a.vtkhdf", "-o", "x.png", "--cast", "none.json"}, "none.json"}};
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
