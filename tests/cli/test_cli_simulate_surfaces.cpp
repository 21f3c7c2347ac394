/// @file test_cli_simulate_surfaces.cpp
/// Bodies made of a closed surface with a lattice: a coarser surface that touches, the given one
/// for the eye.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <tetwarp/scene_io.hpp>
#include <vector>

#include "host/base/point3.hpp"
#include "tests/support/h5_numbers.hpp"
#include "tests/support/simulate_scene.hpp"

namespace tetwarp::test {
namespace {
/// A bumpy ball of 5 cm.
Surface ball(int rings, int sides) {
  using std::numbers::pi;
  Surface surface;
  const auto add = [&](double polar, double turn) {
    const double radius = 0.05 + 0.004 * std::sin(3 * turn) * std::sin(polar);
    surface.points.push_back({radius * std::sin(polar) * std::cos(turn),
                              radius * std::sin(polar) * std::sin(turn), radius * std::cos(polar)});
  };
  add(0, 0);
  for (int r = 1; r < rings; ++r) {
    for (int s = 0; s < sides; ++s) add(pi * r / rings, 2 * pi * s / sides);
  }
  add(pi, 0);
  const auto last = static_cast<std::int32_t>(surface.points.size()) - 1;
  const auto at = [&](int r, int s) { return 1 + (r - 1) * sides + s % sides; };
  for (int s = 0; s < sides; ++s) {
    surface.triangles.push_back({0, at(1, s), at(1, s + 1)});
    for (int r = 1; r + 1 < rings; ++r) {
      surface.triangles.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
      surface.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
    }
    surface.triangles.push_back({at(rings - 1, s), last, at(rings - 1, s + 1)});
  }
  return surface;
}

void write_obj(const std::string& path, const Surface& surface) {
  std::ostringstream text;
  text.precision(17);
  for (const Point3& x : surface.points) text << "v " << x[0] << ' ' << x[1] << ' ' << x[2] << '\n';
  for (const auto& [a, b, c] : surface.triangles) {
    text << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
  }
  write_text(path, text.str());
}

std::string scene_of(const std::string& surface) {
  return R"({"tetwarp_scene": 1, "time_step": 0.004, "duration": 0.2,
    "obstacles": [{"name": "floor", "plane": {"normal": [0, 0, 1], "point": [0, 0, 0]}}],
    "bodies": [{"name": "ball", "kind": "fem", "mesh": {"file": "ball.obj"},
                "lattice": {"cells": [3, 3, 3]})" +
         surface + R"(, "material": {"E": 2e4, "nu": 0.4, "density": 1000},
                "pose": {"position": [0, 0, 0.06]}}], "output": {"every": 10}})";
}

double enclosed(const Surface& surface) {
  double sum = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    sum += dot(at(surface.points, a), cross(at(surface.points, b), at(surface.points, c))) / 6;
  }
  return sum;
}

/// Distance of a point from a triangle: the least over its parts.
double distance_to(const std::array<Point3, 3>& t, const Point3& x) {
  const Point3 normal = cross(minus(t[1], t[0]), minus(t[2], t[0]));
  bool is_over = true;
  double least = 1e300;
  for (std::size_t n = 0; n < 3; ++n) {
    const Point3 along = minus(t[(n + 1) % 3], t[n]), to = minus(x, t[n]);
    is_over &= dot(cross(normal, along), to) >= 0;
    const double share = std::clamp(dot(along, to) / dot(along, along), 0.0, 1.0);
    least = std::min(least, norm(minus(to, times(share, along))));
  }
  return is_over ? std::abs(dot(normal, minus(x, t[0]))) / norm(normal) : least;
}

double distance_from(const Surface& surface, const std::vector<Point3>& points) {
  double largest = 0;
  for (const Point3& x : points) {
    double least = 1e300;
    for (const auto& [a, b, c] : surface.triangles) {
      least = std::min(
          least,
          distance_to({at(surface.points, a), at(surface.points, b), at(surface.points, c)}, x));
    }
    largest = std::max(largest, least);
  }
  return largest;
}

std::vector<Point3> frame_of(const std::string& path, std::size_t count, std::size_t frame) {
  const std::vector<double> points = h5_numbers(path, "VTKHDF/Points");
  const std::vector<double> moved = h5_numbers(path, "VTKHDF/PointData/displacement");
  std::vector<Point3> places(count);
  for (std::size_t n = 0; n < 3 * count; ++n) {
    places[n / 3][n % 3] = points[n] + moved[3 * count * frame + n];
  }
  return places;
}

/// Whether this build reads surfaces; otherwise the error has named the package.
bool reads_surfaces(const CommandResult& result) {
  return result.err.find("libvtk9-dev") == std::string::npos;
}

TEST(GivenSurfaces, TouchWithACoarserOneAndAreSeenAsTheyAre) {
  const TemporaryFolder folder;
  const Surface fine = ball(24, 36);
  write_obj(folder / "ball.obj", fine);
  write_text(folder / "scene.json", scene_of(R"(, "surface": {"distance": 0.0012})"));

  const CommandResult result = run_command(
      folder, {"simulate", "scene.json", "-o", "out", "--quiet", "--picture", "--pixels", "64,48"});

  if (!reads_surfaces(result)) GTEST_SKIP() << "needs libvtk9-dev";
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string out = (folder.path() / "out").string();
  const auto report = nlohmann::json::parse(text_of(out + "/report.json"));
  Surface seen = fine;  // an .obj is read in single precision
  const std::vector<double> rest = h5_numbers(out + "/ball.look.vtkhdf", "VTKHDF/Points");
  ASSERT_EQ(rest.size(), 3 * fine.points.size());
  for (std::size_t n = 0; n < rest.size(); ++n) seen.points[n / 3][n % 3] = rest[n];
  EXPECT_NEAR(report["bodies"]["ball"]["mass"].get<double>() / (1000 * enclosed(seen)), 1, 1e-9);
  const Surface coarse = read_surface(out + "/ball.surface.vtkhdf");
  EXPECT_LT(2 * coarse.triangles.size(), fine.triangles.size());
  // Points of the files are those of the geometry; `coarse` has the displacement of frame 0.
  Surface lowered = coarse;
  lowered.points = frame_of(out + "/ball.surface.vtkhdf", coarse.points.size(), 0);
  std::vector<Point3> start = frame_of(out + "/ball.look.vtkhdf", fine.points.size(), 0);
  for (std::size_t p = 0; p < start.size(); ++p) {
    for (std::size_t d = 0; d < 3; ++d) {
      ASSERT_NEAR(start[p][d], fine.points[p][d] + (d == 2 ? 0.06 : 0), 1e-6);
    }
  }
  EXPECT_LE(distance_from(lowered, start), 0.0012 + 1e-6);
  EXPECT_GT(distance_from(lowered, start), 1e-4);
  const std::vector<Point3> landed = frame_of(out + "/ball.look.vtkhdf", fine.points.size(), 5);
  double lowest = 1;
  for (const Point3& x : landed) lowest = std::min(lowest, x[2]);
  EXPECT_LT(lowest, 0.002);
  EXPECT_GT(lowest, -0.0013);
}

TEST(GivenSurfaces, TouchAsTheyAreWithoutASurface) {
  const TemporaryFolder folder;
  const Surface fine = ball(10, 14);
  write_obj(folder / "ball.obj", fine);
  write_text(folder / "scene.json", scene_of(""));

  const CommandResult result =
      run_command(folder, {"simulate", "scene.json", "-o", "out", "--quiet", "--steps", "30"});

  if (!reads_surfaces(result)) GTEST_SKIP() << "needs libvtk9-dev";
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string out = (folder.path() / "out").string();
  const auto report = nlohmann::json::parse(text_of(out + "/report.json"));
  EXPECT_EQ(report["bodies"]["ball"]["triangles"], fine.triangles.size());
  EXPECT_FALSE(fs::exists(out + "/ball.look.vtkhdf"));
}

TEST(GivenSurfaces, NameWhatIsWrongInOneLine) {
  const TemporaryFolder folder;
  const Surface fine = ball(10, 14);
  Surface open = fine;
  open.triangles.pop_back();
  Surface tangled = fine;
  for (double& part : tangled.points.front()) part *= -1.5;  // the pole goes through the other one
  struct Case {
    Surface surface;
    std::string key, named;
  };
  const std::string distance = R"(, "surface": {"distance": 0.001})";
  const std::vector<Case> cases{
      {open, "", "bodies[0].mesh"},
      {open, distance, "bodies[0].mesh"},
      {tangled, "", "intersects itself, in triangles"},
      {fine, R"(, "surface": {"distance": 0.09})", "is too coarse"},
      {fine, R"(, "surface": {"distance": -1})", "expected a length above 0"},
      {fine, R"(, "surface": {"distance": 0.001, "triangles": 9})", "expected one of triangles"}};
  for (const Case& one : cases) {
    write_obj(folder / "ball.obj", one.surface);
    write_text(folder / "scene.json", scene_of(one.key));

    const CommandResult result = run_command(folder, {"simulate", "scene.json", "-o", "out"});

    if (!reads_surfaces(result)) GTEST_SKIP() << "needs libvtk9-dev";
    EXPECT_EQ(result.exit_code, 1) << one.named;
    EXPECT_TRUE(result.has_one_line_error()) << result.err;
    EXPECT_NE(result.err.find(one.named), std::string::npos) << result.err;
    EXPECT_FALSE(fs::exists(folder / "out"));
  }
}

}  // namespace
}  // namespace tetwarp::test
