/// @file picture_options.hpp
/// Options of pictures in perspective: camera, size, and how volumes are drawn.
#pragma once
#include <CLI/CLI.hpp>
#include <array>
#include <optional>
#include <string>

#include <tetwarp/cast.hpp>

#include "host/cli/common/camera_option.hpp"

namespace tetwarp::cli {

/// As they were given.
struct PictureOptions {
  CameraOption camera;
  std::optional<std::array<int, 2>> pixels;  ///< width, height
  /// How volumes are ray-cast: ct, mr, or the name of a file of a transfer function; empty: they
  /// are not.
  std::string cast;

  bool casts_by_file() const { return !cast.empty() && cast != "ct" && cast != "mr"; }
  /// Width and height [pixel].
  std::array<int, 2> size() const { return pixels.value_or(std::array{960, 640}); }
};

/// Declares --pixels and --cast.
/// @param cast  what --cast does
void declare_picture_options(CLI::App& app, PictureOptions& options, const std::string& cast);

/// The transfer function of --cast for a volume.
/// @param range      of the values of the volume, for the presets
/// @param is_window  the range was chosen: presets fill it, also where it is one of Hounsfield
/// units
/// @throws IoError  as read_transfer_function()
TransferFunction transfer_of(const PictureOptions& options,
                             const Grid& grid,
                             const std::array<double, 2>& range,
                             bool is_window = false);

}  // namespace tetwarp::cli
