/// @file dicom_stack.cpp
/// Choice of the series, checks that slices are alike, and their grid.
#include "io/image/dicom_stack.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>
#include <tetwarp/error.hpp>

#include "host/base/point3.hpp"
#include "io/image/image_header.hpp"

namespace tetwarp {
namespace {
/// Four digits.
std::string short_text(double value) {
  char digits[32];
  const auto end =
      std::to_chars(digits, digits + sizeof digits, value, std::chars_format::general, 4);
  return {digits, end.ptr};
}

Point3 point_of(const std::vector<double>& numbers, std::size_t first = 0) {
  return {numbers[first], numbers[first + 1], numbers[first + 2]};
}

std::string name_of_slice(const DicomSlice& slice) {
  const std::string file = std::filesystem::path(slice.file).filename().string();
  return slice.frame > 0 ? file + " frame " + std::to_string(slice.frame) : file;
}

/// Keeps one series. Throws IoError when there is not the wanted one, or more than one.
void choose_series(const std::string& path,
                   const std::string& series,
                   std::vector<DicomSlice>& slices) {
  if (slices.empty()) {
    throw IoError(path, "", "holds no DICOM image; name the folder of the images of a series");
  }
  std::map<std::string, std::pair<std::string, int>> found;
  for (const DicomSlice& slice : slices) {
    auto& [label, count] = found[slice.series];
    label = slice.label;
    ++count;
  }
  if (series.empty() && found.size() == 1) return;
  if (!series.empty() && found.contains(series)) {
    std::erase_if(slices, [&](const DicomSlice& slice) { return slice.series != series; });
    return;
  }
  std::string listed;
  for (const auto& [uid, facts] : found) {
    listed += (listed.empty() ? "" : "; ") + uid + " (" + facts.first + ", " +
              std::to_string(facts.second) + (facts.second == 1 ? " slice)" : " slices)");
  }
  throw IoError(path, "",
                series.empty() ? "holds " + std::to_string(found.size()) +
                                     " series, choose one with --series UID: " + listed
                               : "has no series " + series + ", it has " + listed);
}

bool are_near(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
  return std::ranges::equal(a, b, [&](double x, double y) { return std::abs(x - y) <= tolerance; });
}

/// Throws IoError when a slice lacks its place, or is not like the first one.
void check_alike(const std::string& path, const std::vector<DicomSlice>& slices) {
  const DicomSlice& first = slices.front();
  for (const DicomSlice& slice : slices) {
    const auto fail = [&](const std::string& problem) {
      throw IoError(path, name_of_slice(slice), problem);
    };
    if (slice.position.size() != 3 || slice.orientation.size() != 6 || slice.spacing.size() != 2) {
      fail(
          "has no ImagePositionPatient, ImageOrientationPatient or PixelSpacing, without which it "
          "has no place; convert it to NIfTI, for example by dcm2niix");
    }
    const Point3 row = point_of(slice.orientation), column = point_of(slice.orientation, 3);
    constexpr double tolerance = 1e-3;  // of cosines with few digits
    if (!(std::abs(norm(row) - 1) < tolerance && std::abs(norm(column) - 1) < tolerance &&
          std::abs(dot(row, column)) < tolerance)) {
      fail("has an ImageOrientationPatient that is not two perpendicular unit vectors");
    }
    if (!(slice.spacing[0] > 0 && slice.spacing[1] > 0)) fail("has a PixelSpacing that is not > 0");
    if (!std::isfinite(slice.slope) || !std::isfinite(slice.intercept) || slice.slope == 0) {
      fail("has a rescale slope or intercept that is no finite number, or a slope of 0");
    }
    const std::string differs = " differs from that of " + name_of_slice(first) +
                                "; move what is no slice of the volume to another folder";
    if (slice.columns != first.columns || slice.rows != first.rows) {
      fail("number of rows or columns" + differs);
    }
    if (slice.components != first.components) fail("number of components" + differs);
    if (slice.colors != first.colors) {
      fail("PhotometricInterpretation '" + slice.colors + "'" + differs);
    }
    if (slice.has_table != first.has_table) fail("presence of a ModalityLUTSequence" + differs);
    if (!are_near(slice.orientation, first.orientation, tolerance)) fail("orientation" + differs);
    if (!are_near(slice.spacing, first.spacing, tolerance * first.spacing[0])) {
      fail("pixel spacing" + differs);
    }
  }
}

/// The step from slice to slice, whose sorted places along the normal are `places`.
Point3 step_of(const std::string& path,
               const std::vector<DicomSlice>& slices,
               const std::vector<double>& places) {
  const std::size_t count = slices.size();
  std::vector<double> gaps;
  for (std::size_t n = 1; n < count; ++n) {
    gaps.push_back(places[n] - places[n - 1]);
    const double whole = places.back() - places.front();
    if (gaps.back() > 1e-6 * whole && gaps.back() > 1e-4) continue;
    throw IoError(path, name_of_slice(slices[n]),
                  "lies where " + name_of_slice(slices[n - 1]) +
                      " lies: several times, echoes or copies in one series; keep one of each, or "
                      "convert it to a 4D NIfTI image, for example by dcm2niix");
  }
  const Point3 first = point_of(slices.front().position);
  const Point3 step =
      times(1 / static_cast<double>(count - 1), minus(point_of(slices.back().position), first));
  constexpr double tolerance = 0.02;  // of the step; positions are rounded to few digits
  for (std::size_t n = 0; n < count; ++n) {
    const Point3 expected = plus(first, times(static_cast<double>(n), step));
    const double off = norm(minus(point_of(slices[n].position), expected));
    if (off <= tolerance * norm(step)) continue;
    const auto [low, high] = std::ranges::minmax(gaps);
    throw IoError(path, name_of_slice(slices[n]),
                  "is not where equal distances put it: slices are " + short_text(low) + " to " +
                      short_text(high) +
                      " mm apart; a slice is missing, or the spacing changes: give equally spaced "
                      "slices");
  }
  return step;
}

/// Whole numbers that slices can have after their rescaling, or nothing.
PixelType value_type(const std::vector<DicomSlice>& slices) {
  double low = 0, high = 0;
  bool are_whole = true;
  int bits = 0;
  for (const DicomSlice& slice : slices) {
    const double size = std::ldexp(1.0, slice.bits);
    for (const double stored :
         {slice.is_signed ? -size / 2 : 0, (slice.is_signed ? size / 2 : size) - 1}) {
      low = std::min(low, slice.slope * stored + slice.intercept);
      high = std::max(high, slice.slope * stored + slice.intercept);
    }
    are_whole = are_whole && slice.slope == std::nearbyint(slice.slope) &&
                slice.intercept == std::nearbyint(slice.intercept);
    bits = std::max(bits, slice.bits);
  }
  const auto holds = [&]<class T>(T) {
    return low >= static_cast<double>(std::numeric_limits<T>::min()) &&
           high <= static_cast<double>(std::numeric_limits<T>::max());
  };
  constexpr int float_bits = 24;
  if (!are_whole) return bits <= float_bits ? PixelType::float32 : PixelType::float64;
  if (holds(std::uint8_t{})) return PixelType::uint8;
  if (holds(std::int8_t{})) return PixelType::int8;
  if (holds(std::int16_t{})) return PixelType::int16;
  if (holds(std::uint16_t{})) return PixelType::uint16;
  return holds(std::int32_t{}) ? PixelType::int32 : PixelType::float64;
}
}  // namespace

DicomStack stack_of(const std::string& path,
                    std::vector<DicomSlice> slices,
                    const std::string& series) {
  choose_series(path, series, slices);
  check_alike(path, slices);
  const Point3 row = unit(point_of(slices.front().orientation));
  const Point3 column = unit(point_of(slices.front().orientation, 3));
  const Point3 normal = cross(row, column);
  const auto place_of = [&](const DicomSlice& slice) {
    return dot(point_of(slice.position), normal);
  };
  std::ranges::stable_sort(slices, {}, place_of);
  std::vector<double> places;
  for (const DicomSlice& slice : slices) places.push_back(place_of(slice));

  DicomStack stack;
  const DicomSlice& first = slices.front();
  const Point3 step = slices.size() > 1 ? step_of(path, slices, places)
                                        : times(first.thickness > 0 ? first.thickness : 1, normal);
  // Rounded positions are no tilt.
  const Point3 straight = times(dot(step, normal), normal);
  const double shift = norm(minus(step, straight));
  const bool is_tilted = shift * static_cast<double>(slices.size() - 1) >
                         0.01 * std::min(first.spacing[0], first.spacing[1]);
  if (is_tilted) {
    const double degrees = std::atan2(shift, norm(straight)) * 180 / std::numbers::pi;
    stack.notes.push_back("tilted gantry: slices are shifted by " + short_text(shift) +
                          " mm from one to the next (" + short_text(degrees) +
                          " degrees), the grid is sheared");
  }
  const std::array<Point3, 3> steps{times(first.spacing[1], row), times(first.spacing[0], column),
                                    is_tilted ? step : straight};
  stack.grid.dims = {first.columns, first.rows, std::ssize(slices)};
  try {
    set_image_axes(steps, point_of(first.position), {true, true, false}, stack.grid);
  } catch (const std::invalid_argument& error) {
    throw IoError(path, name_of_slice(first), error.what());
  }
  stack.type = value_type(slices);
  stack.components = first.components;
  stack.slices = std::move(slices);
  return stack;
}

}  // namespace tetwarp
