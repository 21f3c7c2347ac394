/// @file test_cli_plot.cpp
/// `tetwarp plot`: curves of one series and of several, and what a chart may leave out.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "host/cli/tools/chart.hpp"
#include "tests/support/h5_numbers.hpp"
#include "tests/support/simulate_scene.hpp"

namespace tetwarp::test {
namespace {
using cli::chart_points;
using cli::chart_ticks;
using Path = std::vector<std::array<double, 2>>;

/// The curves of a drawing in the order in which they are drawn.
std::vector<Path> paths_in(const std::string& svg) {
  static const std::regex path("<path d=\"([^\"]*)\""), point("[ML]([-0-9.]+),([-0-9.]+)");
  std::vector<Path> paths;
  for (std::sregex_iterator it(svg.begin(), svg.end(), path), end; it != end; ++it) {
    const std::string text = (*it)[1];
    Path places;
    for (std::sregex_iterator at(text.begin(), text.end(), point); at != end; ++at) {
      places.push_back({std::stod((*at)[1]), std::stod((*at)[2])});
    }
    paths.push_back(places);
  }
  return paths;
}

double lowest(const Path& path) {  // on the screen, where y points down
  double y = path.front()[1];
  for (const auto& place : path) y = std::max(y, place[1]);
  return y;
}

double highest(const Path& path) {
  double y = path.front()[1];
  for (const auto& place : path) y = std::min(y, place[1]);
  return y;
}

TEST(Plot, DrawsRunsBesideEachOtherOnTheSameAxes) {
  const SimulateScene scene;
  ASSERT_EQ(scene.simulate({"-o", "long"}).exit_code, 0);
  ASSERT_EQ(scene.simulate({"-o", "short", "--steps", "6"}).exit_code, 0);

  const CommandResult result = run_command(
      scene, {"plot", "long", "short/series.h5", "-o", "out.svg", "--show", "energy/total"});

  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string svg = text_of(scene / "out.svg");
  const std::vector<Path> paths = paths_in(svg);
  ASSERT_EQ(paths.size(), 2u);
  ASSERT_EQ(paths[0].size(), 13u);
  ASSERT_EQ(paths[1].size(), 7u);
  // 400 x 142 pixels for 12 steps and the range of both runs, to a tenth of a pixel.
  const std::vector<double> energy = h5_numbers(scene.in("long", "series.h5"), "energy/total");
  const auto [least, most] = std::minmax_element(energy.begin(), energy.end());
  EXPECT_NEAR(lowest(paths[0]) - highest(paths[0]), 142, 0.11);
  for (std::size_t n = 0; n < energy.size(); ++n) {
    const double down = 142 * (*most - energy[n]) / (*most - *least);
    EXPECT_NEAR(paths[0][n][0] - paths[0][0][0], 400.0 / 12 * static_cast<double>(n), 0.11) << n;
    EXPECT_NEAR(paths[0][n][1] - highest(paths[0]), down, 0.11) << n;
  }
  for (std::size_t n = 0; n < paths[1].size(); ++n) {
    EXPECT_NEAR(paths[1][n][1], paths[0][n][1], 0.11) << n;
    EXPECT_NEAR(paths[1][n][0] - paths[1][0][0], paths[0][n][0] - paths[0][0][0], 0.11) << n;
  }
  EXPECT_NE(svg.find(">energy/total [J]</text>"), std::string::npos);
  EXPECT_NE(svg.find(">short/series.h5</text>"), std::string::npos);
}

TEST(Plot, DrawsEveryDatasetOfAGroupAndLengthsOfVectors) {
  const SimulateScene scene;
  ASSERT_EQ(scene.simulate({"-o", "run"}).exit_code, 0);

  const CommandResult result = run_command(
      scene, {"plot", "run", "-o", "out.svg", "--show", "seconds,momentum", "--over-time"});

  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string svg = text_of(scene / "out.svg");
  EXPECT_EQ(paths_in(svg).size(), 8u);
  for (const char* name : {"assembly", "contact", "detection", "forces", "linear", "total",
                           "update", "momentum", "time [s]", "seconds [s]", "0.12"}) {
    EXPECT_NE(svg.find(std::string(">") + name + "</text>"), std::string::npos) << name;
  }
  const std::vector<double> momentum = h5_numbers(scene.in("run", "series.h5"), "momentum");
  std::vector<double> lengths;
  for (std::size_t n = 0; n < momentum.size(); n += 3) {
    lengths.push_back(std::hypot(momentum[n], momentum[n + 1], momentum[n + 2]));
  }
  const auto [least, most] = std::minmax_element(lengths.begin(), lengths.end());
  const Path drawn = paths_in(svg).back();
  ASSERT_EQ(drawn.size(), lengths.size());
  for (std::size_t n = 0; n < lengths.size(); ++n) {
    EXPECT_NEAR(drawn[n][1] - highest(drawn), 142 * (*most - lengths[n]) / (*most - *least), 0.11);
  }
}

TEST(Plot, RefusesWhatIsNoSeriesOrNotInIt) {
  const SimulateScene scene;
  ASSERT_EQ(scene.simulate({"-o", "run", "--steps", "1"}).exit_code, 0);
  struct Case {
    std::vector<std::string> words;
    const char* message;
  };
  for (const Case& bad : std::vector<Case>{
           {{"plot", "run", "-o", "out.png"}, "the name of a chart ends in .svg"},
           {{"plot", "nothing", "-o", "out.svg"}, "nothing"},
           {{"plot", "scene.json", "-o", "out.svg"}, "scene.json"},
           {{"plot", "run/ball.vtkhdf", "-o", "out.svg"}, "is no series of a simulation"},
           {{"plot", "run", "-o", "out.svg", "--show", "warmth"}, "'/' holds adhered_area"},
           {{"plot", "run", "-o", "out.svg", "--show", "bodies"}, "name one of bodies/ball"}}) {
    const CommandResult result = run_command(scene, bad.words);

    EXPECT_EQ(result.exit_code, 1) << bad.message;
    EXPECT_NE(result.err.find(bad.message), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(fs::exists(scene / "out.svg"));
  }
}

/// Numbers of rows times columns, and of bytes, are beyond 2^64.
TEST(Plot, RefusesADatasetThatNoMemoryHolds) {
  const SimulateScene scene;
  ASSERT_EQ(scene.simulate({"-o", "run", "--steps", "1"}).exit_code, 0);
  const hid_t file = H5Fopen(scene.in("run", "series.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const std::array<hsize_t, 2> dims{1 << 20, (hsize_t{1} << 44) + 1}, chunk{1, 16};
  const hid_t space = H5Screate_simple(2, dims.data(), nullptr);
  const hid_t layout = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(layout, 2, chunk.data());
  const hid_t wide =
      H5Dcreate2(file, "wide", H5T_NATIVE_FLOAT, space, H5P_DEFAULT, layout, H5P_DEFAULT);
  ASSERT_GE(wide, 0);
  H5Dclose(wide);
  H5Pclose(layout);
  H5Sclose(space);
  H5Fclose(file);

  const CommandResult result =
      run_command(scene, {"plot", "run", "-o", "out.svg", "--show", "wide"});

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(result.has_one_line_error()) << result.err;
  EXPECT_NE(result.err.find("wide"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(scene / "out.svg"));
}

/// Whichever run has the dataset that the other one lacks.
TEST(Plot, RefusesGroupsThatDiffer) {
  const SimulateScene scene;
  ASSERT_EQ(scene.simulate({"-o", "all", "--steps", "1"}).exit_code, 0);
  ASSERT_EQ(scene.simulate({"-o", "less", "--steps", "1"}).exit_code, 0);
  const hid_t file = H5Fopen(scene.in("less", "series.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(H5Ldelete(file, "seconds/linear", H5P_DEFAULT), 0);
  H5Fclose(file);

  for (const auto& [first, second] : {std::pair{"all", "less"}, {"less", "all"}}) {
    const CommandResult result =
        run_command(scene, {"plot", first, second, "-o", "out.svg", "--show", "seconds"});

    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(
        result.err.find(std::string(second) + ": seconds: has other datasets than in " + first),
        std::string::npos)
        << result.err;
    EXPECT_FALSE(fs::exists(scene / "out.svg"));
  }
}

TEST(Chart, KeepsEveryPeakInFewPointsPerPixel) {
  std::mt19937 random(51);
  std::normal_distribution<double> normal;
  for (const int size : {0, 1, 31, 32, 33, 1025}) {
    std::vector<double> values(static_cast<std::size_t>(size));
    for (double& value : values) value = normal(random);

    const Path points = chart_points(values, 0, 1, 0, std::max(size - 1, 1), 100);

    EXPECT_EQ(points.size(), std::min(points.size(), values.size()));
    EXPECT_LE(points.size(), 4u * 101);
    EXPECT_TRUE(std::is_sorted(points.begin(), points.end(),
                               [](const auto& a, const auto& b) { return a[0] < b[0]; }));
    for (int pixel = 0; pixel < 100; ++pixel) {
      double least = INFINITY, most = -INFINITY, drawn_least = INFINITY, drawn_most = -INFINITY;
      for (int n = 0; n < size; ++n) {
        if (std::floor(100.0 * n / std::max(size - 1, 1)) != pixel) continue;
        least = std::min(least, values[static_cast<std::size_t>(n)]);
        most = std::max(most, values[static_cast<std::size_t>(n)]);
      }
      for (const auto& [x, y] : points) {
        if (std::floor(x) != pixel) continue;
        drawn_least = std::min(drawn_least, y);
        drawn_most = std::max(drawn_most, y);
      }
      EXPECT_EQ(drawn_least, least) << size << " values, pixel " << pixel;
      EXPECT_EQ(drawn_most, most) << size << " values, pixel " << pixel;
    }
  }
}

TEST(Chart, InterruptsCurvesAtValuesThatAreNotFinite) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const Path points = chart_points({1, nan, 3, INFINITY}, 0, 1, 0, 3, 300);

  ASSERT_EQ(points.size(), 4u);
  EXPECT_EQ(points[0], (std::array<double, 2>{0, 1}));
  EXPECT_TRUE(std::isnan(points[1][1]));
  EXPECT_EQ(points[2], (std::array<double, 2>{200, 3}));
  EXPECT_TRUE(std::isnan(points[3][1]));
}

TEST(Chart, HasThreeToSevenTicksAtRoundNumbersWithinTheRange) {
  std::mt19937 random(52);
  std::uniform_real_distribution<double> exponent(-30, 30), shift(-3, 3);
  for (int k = 0; k < 1000; ++k) {
    const double extent = std::pow(10, exponent(random)), low = extent * shift(random);

    const std::vector<double> ticks = chart_ticks(low, low + extent);

    ASSERT_GE(ticks.size(), 2u) << low << " + " << extent;
    ASSERT_LE(ticks.size(), 7u) << low << " + " << extent;
    EXPECT_GE(ticks.front(), low - 1e-9 * extent);
    EXPECT_LE(ticks.back(), low + extent * (1 + 1e-9));
    const double distance = ticks[1] - ticks[0];
    const double digit = distance / std::pow(10, std::floor(std::log10(distance * 1.0001)));
    EXPECT_TRUE(std::abs(digit - 1) < 1e-6 || std::abs(digit - 2) < 1e-6 ||
                std::abs(digit - 5) < 1e-6)
        << digit;
  }
}

TEST(Chart, HasTicksAtBothEndsThatAreMultiplesOfTheirDistance) {
  for (const double unit : {1.0, 0.1, 1e-7, 1e20}) {
    for (int low = -30; low <= 30; ++low) {
      for (const int extent : {3, 4, 5}) {  // with ticks every 0.5 or 1
        const std::vector<double> ticks = chart_ticks(low * unit, (low + extent) * unit);

        EXPECT_NEAR(ticks.front(), low * unit, 1e-9 * unit) << low << " + " << extent;
        EXPECT_NEAR(ticks.back(), (low + extent) * unit, 1e-9 * unit) << low << " + " << extent;
      }
    }
  }
}

TEST(Chart, LabelsTicksOfSmallRangesByDifferentNumbers) {
  static const std::regex label("text-anchor=\"end\">([^<]*)</text>");
  for (const double extent : {1.0, 1e-6, 1e-8, 1e-10}) {
    const std::string svg =
        cli::draw_chart({"step", {{"run", 0, 1}}, {{"y", {{{"c", {3, 3 + extent}}}}}}});
    std::vector<std::string> labels;
    for (std::sregex_iterator at(svg.begin(), svg.end(), label), end; at != end; ++at) {
      labels.push_back((*at)[1]);
    }

    ASSERT_GE(labels.size(), 2U) << extent;
    EXPECT_EQ(std::adjacent_find(labels.begin(), labels.end()), labels.end()) << svg;
  }
}

TEST(Chart, TakesConstantEmptyAndEnormousCurves) {
  for (const std::vector<double>& values : std::vector<std::vector<double>>{
           {}, {0}, {5, 5}, {1e-320, 0}, {-1e308, 1e308}, {INFINITY}}) {
    const std::string svg =
        cli::draw_chart({"step", {{"a<b", 0, 1}}, {{"y", {{{"c&d", values}}}}}});

    EXPECT_EQ(svg.find("nan"), std::string::npos) << svg;
    EXPECT_EQ(svg.find("inf"), std::string::npos) << svg;
    EXPECT_NE(svg.find("a&lt;b"), std::string::npos) << svg;
    EXPECT_NE(svg.find("c&amp;d"), std::string::npos) << svg;
  }
}
}  // namespace
}  // namespace tetwarp::test
