/// @file picture_options.cpp
/// Sizes and transfer functions of pictures.
#include "host/cli/common/picture_options.hpp"

#include <cmath>
#include <tetwarp/transfer_file.hpp>
#include <vector>

#include "host/cli/common/declare.hpp"

namespace tetwarp::cli {

void declare_picture_options(CLI::App& app, PictureOptions& options, const std::string& cast) {
  app.add_option_function<std::array<int, 2>>(
         "--pixels", [&options](const std::array<int, 2>& numbers) { options.pixels = numbers; },
         "width and height of the pictures [960,640]")
      ->delimiter(',')
      ->check(between(16, 4096))
      ->type_name("W,H");
  app.add_option_function<std::string>(
         "--cast",
         [&options](const std::string& word) { options.cast = word.empty() ? "ct" : word; },
         cast + ", in the colors of computed tomographies, gray, or as a JSON file says [ct]")
      ->expected(0, 1)
      ->type_name("[ct|mr|FILE.json]");
}

TransferFunction transfer_of(const PictureOptions& options,
                             const Grid& grid,
                             const std::array<double, 2>& range,
                             bool is_window) {
  const double length = preset_length(grid);
  if (!options.casts_by_file()) {
    if (!is_window) return {preset_colors(options.cast, range[0], range[1]), length};
    std::vector<ColorPoint> points = preset_colors(options.cast, 0, 1);
    for (ColorPoint& point : points) point.value = std::lerp(range[0], range[1], point.value);
    return {points, length};
  }
  return read_transfer_function(options.cast, length);
}

}  // namespace tetwarp::cli
