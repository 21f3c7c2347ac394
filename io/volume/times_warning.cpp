/// @file times_warning.cpp
/// times_warning(): times that a format does not keep.
#include <charconv>
#include <cmath>
#include <cstddef>
#include <string>
#include <tetwarp/io.hpp>
#include <vector>

#include "io/files/extension.hpp"
#include "io/files/mean_interval.hpp"

namespace tetwarp {
namespace {
/// A time with six digits.
std::string time_text(double time) {
  char digits[32];
  return {digits,
          std::to_chars(digits, digits + sizeof digits, time, std::chars_format::general, 6).ptr};
}

/// Of a format that numbers the steps.
std::string lost_times(const std::string& output, const std::vector<double>& times) {
  for (std::size_t step = 0; step < times.size(); ++step) {
    if (times[step] == static_cast<double>(step)) continue;
    return output +
           ": images of FreeSurfer number their frames, the times of the steps are lost; write "
           ".nii.gz, .nrrd or VTKHDF";
  }
  return {};
}

/// Of a format that keeps the first time and an interval.
std::string uneven_times(const std::string& output, const std::vector<double>& times) {
  const double interval = mean_interval(times);
  for (std::size_t step = 1; step < times.size(); ++step) {
    const double expected = times.front() + interval * static_cast<double>(step);
    if (std::abs(times[step] - expected) <= 1e-3 * std::abs(interval)) continue;
    return output + ": the times of the steps are not equally spaced or do not increase, images " +
           "keep the first one and the interval " + time_text(interval) +
           "; write VTKHDF to keep the times";
  }
  return {};
}

std::string unordered_times(const std::string& output, const std::vector<double>& times) {
  for (std::size_t step = 1; step < times.size(); ++step) {
    if (times[step] > times[step - 1]) continue;
    return output + ": the times of the steps do not increase: " + time_text(times[step - 1]) +
           " is followed by " + time_text(times[step]) +
           "; programs that show the file leave out steps or order them by time; correct the "
           "times of the steps";
  }
  return {};
}
}  // namespace

std::string times_warning(const std::string& output, const std::vector<double>& times) {
  if (has_extension(output, ".mgz") || has_extension(output, ".mgh")) {
    return lost_times(output, times);
  }
  const bool keeps_interval = has_nifti_name(output) || has_image_name(output);
  return keeps_interval ? uneven_times(output, times) : unordered_times(output, times);
}

}  // namespace tetwarp
