/// @file test_io_points.cpp
/// Points of simulations that grow, another number at every step.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <tetwarp/error.hpp>
#include <vector>

#include "io/vtkhdf/simulation_points.hpp"
#include "tests/support/h5_numbers.hpp"
#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
using Numbers = std::vector<double>;

const std::vector<PointArray> arrays{{"normal", 3}, {"gap"}, {"body", 1, true}};

/// `count` points whose numbers tell the step and the point.
void append(StepPointsWriter& writer, double step, std::size_t count) {
  std::vector<Point3> points(count);
  std::array<Numbers, 3> numbers;
  for (std::size_t p = 0; p < count; ++p) {
    points[p] = {step, double(p), 0};
    numbers[0].insert(numbers[0].end(), {step, 0, 1});
    numbers[1].push_back(10 * step + double(p));
    numbers[2].push_back(double(p));
  }
  const std::array<std::span<const double>, 3> values{numbers[0], numbers[1], numbers[2]};
  writer.append(0.5 * step, points, values);
}

TEST(StepPointsWriter, LeavesAFileThatIsCompleteAfterEveryStep) {
  const ScratchFolder folder;
  const std::string path = folder / "points.vtkhdf";
  StepPointsWriter writer(path, arrays);
  append(writer, 0, 0);
  append(writer, 1, 2);
  append(writer, 2, 0);
  append(writer, 3, 1);

  const auto numbers = [&](const std::string& name) { return h5_numbers(path, "VTKHDF/" + name); };
  EXPECT_EQ(numbers("Steps/Values"), (Numbers{0, 0.5, 1, 1.5}));
  EXPECT_EQ(numbers("NumberOfPoints"), (Numbers{0, 2, 0, 1}));
  EXPECT_EQ(numbers("NumberOfCells"), (Numbers{0, 2, 0, 1}));
  EXPECT_EQ(numbers("NumberOfConnectivityIds"), (Numbers{0, 2, 0, 1}));
  EXPECT_EQ(numbers("Steps/PartOffsets"), (Numbers{0, 1, 2, 3}));
  EXPECT_EQ(numbers("Steps/NumberOfParts"), (Numbers{1, 1, 1, 1}));
  for (const char* name : {"PointOffsets", "CellOffsets", "ConnectivityIdOffsets",
                           "PointDataOffsets/normal", "PointDataOffsets/body"}) {
    EXPECT_EQ(numbers(std::string("Steps/") + name), (Numbers{0, 0, 2, 2})) << name;
  }
  EXPECT_EQ(numbers("Points"), (Numbers{1, 0, 0, 1, 1, 0, 3, 0, 0}));
  EXPECT_EQ(numbers("Connectivity"), (Numbers{0, 1, 0}));
  EXPECT_EQ(numbers("Offsets"), (Numbers{0, 0, 1, 2, 0, 0, 1})) << "one more than cells per step";
  EXPECT_EQ(numbers("Types"), (Numbers{1, 1, 1}));
  EXPECT_EQ(numbers("PointData/gap"), (Numbers{10, 11, 30}));
  EXPECT_EQ(numbers("PointData/body"), (Numbers{0, 1, 0}));
  EXPECT_EQ(numbers("PointData/normal").size(), 9u);
}

TEST(StepPointsWriter, GoesOnBehindAStep) {
  const ScratchFolder folder;
  const std::string path = folder / "continued.vtkhdf";
  {
    StepPointsWriter writer(path, arrays);
    for (std::size_t step = 0; step < 4; ++step) append(writer, double(step), step);
  }
  {
    StepPointsWriter writer(path, arrays, 2);
    EXPECT_EQ(h5_numbers(path, "VTKHDF/Steps/Values").size(), 4u) << "nothing is changed yet";
    writer.drop_later();
    append(writer, 5, 1);
  }

  EXPECT_EQ(h5_numbers(path, "VTKHDF/Steps/Values"), (Numbers{0, 0.5, 2.5}));
  EXPECT_EQ(h5_numbers(path, "VTKHDF/NumberOfPoints"), (Numbers{0, 1, 1}));
  EXPECT_EQ(h5_numbers(path, "VTKHDF/Steps/PointOffsets"), (Numbers{0, 0, 1}));
  EXPECT_EQ(h5_numbers(path, "VTKHDF/Offsets"), (Numbers{0, 0, 1, 0, 1}));
  EXPECT_EQ(h5_numbers(path, "VTKHDF/PointData/gap"), (Numbers{10, 50}));
  EXPECT_THROW(StepPointsWriter(path, arrays, 5), IoError) << "fewer steps";
  EXPECT_THROW(StepPointsWriter(path, {{"normal", 1}}, 1), IoError) << "another shape";
}

TEST(StepPointsWriter, RefusesNumbersThatAreNotFinite) {
  const ScratchFolder folder;
  const std::string path = folder / "finite.vtkhdf";
  StepPointsWriter writer(path, {{"gap"}});
  const std::array<Point3, 1> point{Point3{0, 0, 0}};
  const Numbers bad{std::numeric_limits<double>::quiet_NaN()}, two{1, 2};
  const std::array<std::span<const double>, 1> not_finite{bad}, too_many{two};

  EXPECT_THROW(writer.append(0, point, not_finite), IoError);
  EXPECT_THROW(writer.append(0, point, too_many), IoError);

  EXPECT_EQ(h5_numbers(path, "VTKHDF/Steps/Values").size(), 0u);
}
}  // namespace
}  // namespace tetwarp::test
