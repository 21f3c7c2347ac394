/// @file render_volume.cpp
/// Pictures of volumes: middle slices and a maximum-intensity projection in gray levels.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <tetwarp/cast.hpp>
#include <tetwarp/make.hpp>
#include <vector>

#include "host/base/counter_hash.hpp"
#include "host/base/parallel.hpp"
#include "host/base/pixel_dispatch.hpp"
#include "host/make/shown_value.hpp"

namespace tetwarp {
namespace {
constexpr int largest_height = 4096;
constexpr double largest_aspect = 8;           // width to height of a panel, or its inverse
constexpr std::int64_t max_samples = 1 << 18;  // for the percentiles
constexpr std::uint8_t separator_gray = 48;

/// The values that are drawn black and white.
struct Window {
  double low;
  double high;

  /// Gray of a value, 0 to 1; of NaN 0. When low equals high, 1 above and 0 otherwise.
  double gray_of(double value) const {
    if (!(value > low)) return 0;
    return value >= high ? 1 : (value - low) / (high - low);
  }
};

/// The finite values of all voxels of a small volume, of randomly chosen voxels of a large one.
std::vector<double> finite_values(const Volume& volume) {
  const std::int64_t voxel_count = volume.grid.voxel_count();
  const std::int64_t count = std::min(voxel_count, max_samples);
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(count));
  with_pixel_type(volume.type, [&]<class T>(T) {
    const T* samples = volume.samples<T>().data();
    for (std::int64_t n = 0; n < count; ++n) {
      const std::int64_t v =
          count == voxel_count ? n
                               : static_cast<std::int64_t>(hash_of(static_cast<std::uint64_t>(n)) %
                                                           static_cast<std::uint64_t>(voxel_count));
      const double value = shown_value(samples + v * volume.components, volume.components);
      if (std::isfinite(value)) values.push_back(value);
    }
  });
  return values;
}

double percentile(std::vector<double>& values, double percent) {
  const auto rank = std::lround(percent / 100 * static_cast<double>(values.size() - 1));
  const auto at = values.begin() + rank;
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

Window window_of(const Volume& volume, const RenderOptions& options) {
  Window window{options.low.value_or(0), options.high.value_or(1)};
  if (!options.low || !options.high) {
    std::vector<double> values = finite_values(volume);
    if (!values.empty()) {
      if (!options.low) window.low = percentile(values, 1);
      if (!options.high) window.high = percentile(values, 99.5);
    }
  }
  return window;
}

/// A picture with one pixel per voxel, rows from top to bottom.
struct Plane {
  std::int64_t width;
  std::int64_t height;
  double aspect;  ///< true width over true height
  std::vector<double> gray;

  double at(std::int64_t x, std::int64_t y) const {
    return gray[static_cast<std::size_t>(y * width + x)];
  }
};

double length_of(const Grid& grid, std::size_t axis) {
  const auto& d = grid.direction;
  return static_cast<double>(grid.dims[axis]) * grid.spacing[axis] *
         std::hypot(d[axis], d[3 + axis], d[6 + axis]);
}

/// Content of a panel: grid axis `right` to the right and grid axis `vertical` upwards or
/// downwards; either the middle slice of the third axis or the maximum along it.
struct PanelView {
  std::size_t right;
  std::size_t vertical;
  bool points_up;
  bool is_projection;
};

/// As in radiology: coronal and sagittal panels with the head at the top, axial ones the first row.
constexpr std::array<PanelView, 4> panel_views{{{0, 1, false, false},  // axial
                                                {0, 2, true, false},   // coronal
                                                {1, 2, true, false},   // sagittal
                                                {0, 2, true, true}}};  // projection along j

/// Whether a panel shows more than a line of voxels and something that no other panel shows. Of
/// images of a single slice one panel is left, of a single row all.
bool is_shown(const Grid& grid, const PanelView& view) {
  const auto flat_axes = std::ranges::count(grid.dims, 1);
  const std::size_t depth_axis = 3 - view.right - view.vertical;
  return flat_axes != 1 || (grid.dims[depth_axis] == 1 && !view.is_projection);
}

Plane draw(const Volume& volume, const PanelView& view, const Window& window) {
  const Grid& grid = volume.grid;
  const std::size_t depth_axis = 3 - view.right - view.vertical;
  const std::array<std::int64_t, 3> stride{1, grid.dims[0], grid.dims[0] * grid.dims[1]};
  const std::int64_t depth = grid.dims[depth_axis];
  const std::int64_t first = view.is_projection ? 0 : depth / 2;
  const std::int64_t last = view.is_projection ? depth : first + 1;
  Plane plane{grid.dims[view.right],
              grid.dims[view.vertical],
              length_of(grid, view.right) / length_of(grid, view.vertical),
              {}};
  plane.gray.resize(static_cast<std::size_t>(plane.width * plane.height));
  with_pixel_type(volume.type, [&]<class T>(T) {
    const T* samples = volume.samples<T>().data();
    parallel_for(thread_count(0), plane.height, [&](std::int64_t y) {
      const std::int64_t row = view.points_up ? plane.height - 1 - y : y;
      double* gray = plane.gray.data() + y * plane.width;
      for (std::int64_t d = first; d < last; ++d) {
        for (std::int64_t x = 0; x < plane.width; ++x) {
          const std::int64_t voxel =
              x * stride[view.right] + row * stride[view.vertical] + d * stride[depth_axis];
          const double value = shown_value(samples + voxel * volume.components, volume.components);
          gray[x] = std::max(gray[x], window.gray_of(value));
        }
      }
    });
  });
  return plane;
}

int panel_width(const Plane& plane, int height) {
  const double aspect = std::clamp(plane.aspect, 1 / largest_aspect, largest_aspect);
  return std::max(1, static_cast<int>(std::lround(aspect * height)));
}

/// The two voxels around the center of a pixel, and its position between them, 0 to 1.
struct Tap {
  std::int64_t voxel;
  std::int64_t next;
  double fraction;
};

Tap tap_of(int pixel, int pixel_count, std::int64_t voxel_count) {
  const auto last = static_cast<double>(voxel_count - 1);
  const double scale = static_cast<double>(voxel_count) / pixel_count;
  const double position = std::clamp((pixel + 0.5) * scale - 0.5, 0.0, last);
  const auto voxel = static_cast<std::int64_t>(position);
  return {voxel, std::min(voxel + 1, voxel_count - 1), position - static_cast<double>(voxel)};
}

/// Draws the plane, linearly interpolated, with its top left pixel at (left, top).
void paste(const Plane& plane, int left, int top, int width, int height, Image& image) {
  for (int y = 0; y < height; ++y) {
    const Tap row = tap_of(y, height, plane.height);
    for (int x = 0; x < width; ++x) {
      const Tap column = tap_of(x, width, plane.width);
      const double above = std::lerp(plane.at(column.voxel, row.voxel),
                                     plane.at(column.next, row.voxel), column.fraction);
      const double below = std::lerp(plane.at(column.voxel, row.next),
                                     plane.at(column.next, row.next), column.fraction);
      const auto level =
          static_cast<std::uint8_t>(std::lround(255 * std::lerp(above, below, row.fraction)));
      const auto pixel = static_cast<std::size_t>(top + y) * static_cast<std::size_t>(image.width) +
                         static_cast<std::size_t>(left + x);
      std::fill_n(image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * pixel), 3, level);
    }
  }
}

void check_arguments(std::span<const Volume* const> volumes, const RenderOptions& options) {
  if (volumes.empty()) throw std::invalid_argument("render: no volume");
  for (const Volume* volume : volumes) {
    if (volume == nullptr) throw std::invalid_argument("render: a volume is a null pointer");
    check_grid(volume->grid, "render: volume '" + volume->name + "'");
    static_cast<void>(VolumeView(*volume));  // throws unless the samples fit the grid
  }
  if (options.height < 1 || options.height > largest_height) {
    throw std::invalid_argument("render: height " + std::to_string(options.height) +
                                ", expected 1 to " + std::to_string(largest_height));
  }
  for (const auto& bound : {options.low, options.high}) {
    if (bound && !std::isfinite(*bound)) {
      throw std::invalid_argument("render: a bound of the window is not finite");
    }
  }
  if (options.low && options.high && *options.low >= *options.high) {
    throw std::invalid_argument("render: low " + std::to_string(*options.low) +
                                " is not below high " + std::to_string(*options.high));
  }
}
}  // namespace

RenderOptions with_window(const Volume& volume, const RenderOptions& options) {
  const Volume* const checked = &volume;
  check_arguments({&checked, 1}, options);
  const Window window = window_of(volume, options);
  const bool is_flat = !(window.low < window.high);  // the least value above low is white
  return {window.low, is_flat ? std::nextafter(window.low, INFINITY) : window.high, options.height};
}

Image render(std::span<const Volume* const> volumes, const RenderOptions& options) {
  check_arguments(volumes, options);
  const Window window = window_of(*volumes.front(), options);
  const int gap = std::max(1, options.height / 180);
  Image image;
  std::vector<std::vector<Plane>> rows;
  for (const Volume* volume : volumes) {
    auto& row = rows.emplace_back();
    int width = -gap;
    for (const PanelView& view : panel_views) {
      if (!is_shown(volume->grid, view)) continue;
      row.push_back(draw(*volume, view, window));
      width += gap + panel_width(row.back(), options.height);
    }
    image.width = std::max(image.width, width);
  }
  const int row_step = options.height + gap;
  image.height = static_cast<int>(rows.size()) * row_step - gap;
  image.rgb.assign(
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3,
      separator_gray);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    int left = 0;
    for (const Plane& plane : rows[r]) {
      const int width = panel_width(plane, options.height);
      paste(plane, left, static_cast<int>(r) * row_step, width, options.height, image);
      left += width + gap;
    }
  }
  return image;
}

}  // namespace tetwarp
