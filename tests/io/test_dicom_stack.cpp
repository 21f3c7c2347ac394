/// @file test_dicom_stack.cpp
/// Slices of DICOM files as volumes: places, order, types of values, refusals. Files themselves:
/// tests/io/check_dicom.py.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <tetwarp/error.hpp>
#include <vector>

#include "host/base/point3.hpp"
#include "io/image/dicom_stack.hpp"

namespace tetwarp::test {
namespace {
/// Where the slices of a made-up volume are, in LPS.
struct Place {
  Point3 row, column, normal, origin;
};

Place random_place(std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1, 1);
  const auto point = [&] { return Point3{number(random), number(random), number(random)}; };
  Place place;
  place.row = unit(point());
  place.normal = unit(cross(place.row, point()));
  place.column = cross(place.normal, place.row);
  place.origin = times(300, point());
  return place;
}

/// @param step  from slice to slice
std::vector<DicomSlice> slices_at(const Place& place, const Point3& step, int count) {
  std::vector<DicomSlice> slices;
  for (int k = 0; k < count; ++k) {
    const Point3 at = plus(place.origin, times(k, step));
    DicomSlice slice{.file = std::to_string(k), .series = "1.2", .label = "CT"};
    slice.columns = 6;
    slice.rows = 5;
    slice.bits = 12;
    slice.position = {at[0], at[1], at[2]};
    slice.orientation = {place.row[0],    place.row[1],    place.row[2],
                         place.column[0], place.column[1], place.column[2]};
    slice.spacing = {0.75, 0.5};
    slices.push_back(slice);
  }
  return slices;
}

std::string refusal_of(const std::vector<DicomSlice>& slices, const std::string& series = "") {
  try {
    stack_of("folder", slices, series);
  } catch (const IoError& error) {
    return error.what();
  }
  return "none";
}

/// RAS of LPS.
Point3 turned(const Point3& point) {
  return {-point[0], -point[1], point[2]};
}

TEST(DicomStack, PutsEachSampleWhereItsSliceSays) {
  std::mt19937 random(3);
  for (const int count : {1, 2, 31, 33}) {
    for (const double tilt : {0.0, 0.4, -0.9}) {
      const Place place = random_place(random);
      const Point3 step = plus(times(2.5, place.normal), times(count > 1 ? tilt : 0, place.column));
      std::vector<DicomSlice> slices = slices_at(place, step, count);
      slices.front().thickness = 2.5;
      std::ranges::shuffle(slices, random);

      const DicomStack stack = stack_of("folder", slices, "");

      EXPECT_EQ(stack.grid.dims, (std::array<std::int64_t, 3>{6, 5, count}));
      for (int k = 0; k < count; ++k) {
        EXPECT_EQ(stack.slices[static_cast<std::size_t>(k)].file, std::to_string(k));
        const Point3 expected =
            turned(plus(plus(place.origin, times(k, step)),
                        plus(times(4 * 0.5, place.row), times(3 * 0.75, place.column))));
        EXPECT_LT(norm(minus(stack.grid.world_of({4, 3, static_cast<double>(k)}), expected)), 1e-9);
      }
      EXPECT_EQ(stack.notes.size(), count > 1 && tilt != 0 ? 1U : 0U);
    }
  }
}

TEST(DicomStack, SnapsRoundedPositionsToTheNormal) {
  std::mt19937 random(4);
  const Place place = random_place(random);
  std::vector<DicomSlice> slices = slices_at(place, times(0.625, place.normal), 200);
  for (DicomSlice& slice : slices) {
    for (double& number : slice.position) number = std::round(number * 1e3) / 1e3;
  }

  const DicomStack stack = stack_of("folder", slices, "");

  EXPECT_TRUE(stack.notes.empty());
  const auto& d = stack.grid.direction;
  EXPECT_NEAR(d[0] * d[2] + d[3] * d[5] + d[6] * d[8], 0, 1e-12);
}

TEST(DicomStack, TakesTheSmallestTypeThatHoldsAllValues) {
  struct Case {
    int bits;
    bool is_signed;
    double slope, intercept;
    PixelType type;
  };
  for (const Case& one :
       {Case{8, false, 1, 0, PixelType::uint8}, Case{8, true, 1, 0, PixelType::int8},
        Case{8, false, 1, -1, PixelType::int16}, Case{12, false, 1, -1024, PixelType::int16},
        Case{16, false, 1, 0, PixelType::uint16}, Case{16, false, 1, -1024, PixelType::int32},
        Case{16, true, 1, 0, PixelType::int16}, Case{32, false, 1, 0, PixelType::float64},
        Case{12, false, 2, -10, PixelType::int16}, Case{8, false, -1, 255, PixelType::uint8},
        Case{8, false, -2, 0, PixelType::int16}, Case{16, true, 2, 0, PixelType::int32},
        Case{16, false, 1e5, 0, PixelType::float64}, Case{12, false, 1, 0.5, PixelType::float32},
        Case{16, true, 0.1, 0, PixelType::float32}, Case{32, false, 0.1, 0, PixelType::float64}}) {
    std::mt19937 random(5);
    const Place place = random_place(random);
    std::vector<DicomSlice> slices = slices_at(place, place.normal, 3);
    DicomSlice& last = slices.back();
    last.bits = one.bits;
    last.is_signed = one.is_signed;
    last.slope = one.slope;
    last.intercept = one.intercept;
    if (one.bits == 8) slices[0].bits = slices[1].bits = 7;

    EXPECT_EQ(stack_of("folder", slices, "").type, one.type) << one.bits << " " << one.intercept;
  }
}

TEST(DicomStack, RefusesWhatMakesNoVolume) {
  std::mt19937 random(6);
  const Place place = random_place(random);
  const std::vector<DicomSlice> good = slices_at(place, times(2, place.normal), 6);
  const auto with = [&](auto change) {
    std::vector<DicomSlice> slices = good;
    change(slices);
    return refusal_of(slices);
  };
  EXPECT_EQ(refusal_of(good), "none");
  EXPECT_NE(refusal_of({}).find("holds no DICOM image"), std::string::npos);
  EXPECT_NE(with([](auto& s) { s.erase(s.begin() + 2); }).find("slices are 2 to 4 mm apart"),
            std::string::npos);
  EXPECT_NE(with([](auto& s) { s[3] = s[2]; }).find("lies where 2 lies"), std::string::npos);
  EXPECT_NE(with([](auto& s) { s[3].rows = 4; }).find("rows or columns differs"),
            std::string::npos);
  EXPECT_NE(with([](auto& s) { s[3].components = 3; }).find("number of components"),
            std::string::npos);
  EXPECT_NE(with([](auto& s) { s[3].colors = "MONOCHROME1"; }).find("'MONOCHROME1' differs"),
            std::string::npos);
  EXPECT_NE(with([](auto& s) { s[3].has_table = true; }).find("ModalityLUTSequence differs"),
            std::string::npos);
  EXPECT_NE(
      with([](auto& s) { std::swap(s[3].spacing[0], s[3].spacing[1]); }).find("pixel spacing"),
      std::string::npos);
  EXPECT_NE(with([](auto& s) { s[3].position.clear(); }).find("has no ImagePositionPatient"),
            std::string::npos);
  EXPECT_NE(with([](auto& s) { s[3].series = "1.3"; }).find("holds 2 series, choose one"),
            std::string::npos);
  EXPECT_NE(refusal_of(good, "1.9").find("has no series 1.9, it has 1.2 (CT, 6 slices)"),
            std::string::npos);
}
}  // namespace
}  // namespace tetwarp::test
