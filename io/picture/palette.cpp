/// @file palette.cpp
/// Divides the colors of a picture at the mean of the box that spreads most.
#include "io/picture/palette.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace tetwarp {
namespace {
constexpr std::size_t most_colors = 256;
constexpr int bits = 6;  // per channel of a histogram bin
constexpr std::size_t bin_count = std::size_t{1} << (3 * bits);

/// Pixels whose colors agree to 6 bits per channel.
struct Bin {
  std::size_t key = 0;
  double count = 0;
  std::array<double, 3> mean{};
};

/// A range of bins, and the spread of their colors.
struct ColorBox {
  std::size_t first = 0, last = 0;
  std::array<double, 3> mean{};
  double spread = 0;     ///< sum of squared distances from the mean along `axis`
  std::size_t axis = 0;  ///< on which it is largest
};

std::size_t key_of(const std::uint8_t* rgb) {
  std::size_t key = 0;
  for (int c = 0; c < 3; ++c) key = (key << bits) | (rgb[c] >> (8 - bits));
  return key;
}

template <class Visit>
void for_each_pixel(const Image& image, const PictureBox& box, const Visit& visit) {
  for (int y = box.top; y < box.top + box.height; ++y) {
    const std::uint8_t* row = image.rgb.data() + 3 * (static_cast<std::size_t>(y) *
                                                          static_cast<std::size_t>(image.width) +
                                                      static_cast<std::size_t>(box.left));
    for (int x = 0; x < box.width; ++x) visit(row + 3 * x);
  }
}

std::vector<Bin> bins_of(const Image& image, const PictureBox& box) {
  std::vector<Bin> all(bin_count);
  for_each_pixel(image, box, [&](const std::uint8_t* rgb) {
    Bin& bin = all[key_of(rgb)];
    ++bin.count;
    for (std::size_t c = 0; c < 3; ++c) bin.mean[c] += rgb[c];
  });
  std::vector<Bin> used;
  for (std::size_t key = 0; key < bin_count; ++key) {
    if (all[key].count == 0) continue;
    used.push_back(all[key]);
    used.back().key = key;
    for (double& mean : used.back().mean) mean /= all[key].count;
  }
  return used;
}

ColorBox box_of(const std::vector<Bin>& bins, std::size_t first, std::size_t last) {
  ColorBox box{first, last};
  double count = 0;
  std::array<double, 3> squares{};
  for (std::size_t b = first; b < last; ++b) {
    count += bins[b].count;
    for (std::size_t c = 0; c < 3; ++c) box.mean[c] += bins[b].count * bins[b].mean[c];
  }
  for (double& mean : box.mean) mean /= count;
  for (std::size_t b = first; b < last; ++b) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double distance = bins[b].mean[c] - box.mean[c];
      squares[c] += bins[b].count * distance * distance;
    }
  }
  box.axis = static_cast<std::size_t>(std::ranges::max_element(squares) - squares.begin());
  box.spread = squares[box.axis];
  return box;
}

std::vector<ColorBox> divided(std::vector<Bin>& bins) {
  std::vector<ColorBox> boxes{box_of(bins, 0, bins.size())};
  while (boxes.size() < most_colors) {
    const auto widest = std::ranges::max_element(boxes, {}, &ColorBox::spread);
    if (!(widest->spread > 0)) break;
    const ColorBox box = *widest;
    const auto begin = bins.begin();
    const auto middle = std::stable_partition(
        begin + static_cast<std::ptrdiff_t>(box.first),
        begin + static_cast<std::ptrdiff_t>(box.last),
        [&](const Bin& bin) { return bin.mean[box.axis] <= box.mean[box.axis]; });
    const auto at = static_cast<std::size_t>(middle - begin);
    if (at == box.first || at == box.last) break;  // spread of rounding only
    *widest = box_of(bins, box.first, at);
    boxes.push_back(box_of(bins, at, box.last));
  }
  return boxes;
}

std::uint8_t nearest(const std::vector<ColorBox>& boxes, const Bin& bin) {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    double distance = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      distance += (bin.mean[c] - boxes[b].mean[c]) * (bin.mean[c] - boxes[b].mean[c]);
    }
    if (distance < least) {
      least = distance;
      best = b;
    }
  }
  return static_cast<std::uint8_t>(best);
}
}  // namespace

IndexedPicture index_picture(const Image& image, const PictureBox& box) {
  std::vector<Bin> bins = bins_of(image, box);
  const std::vector<ColorBox> boxes = divided(bins);
  IndexedPicture picture;
  for (const ColorBox& color : boxes) {
    Color& rgb = picture.palette.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      rgb[c] = static_cast<std::uint8_t>(std::lround(color.mean[c]));
    }
  }
  std::vector<std::uint8_t> index_of(bin_count);
  for (const Bin& bin : bins) index_of[bin.key] = nearest(boxes, bin);
  picture.indices.reserve(static_cast<std::size_t>(box.width) *
                          static_cast<std::size_t>(box.height));
  for_each_pixel(image, box, [&](const std::uint8_t* rgb) {
    picture.indices.push_back(index_of[key_of(rgb)]);
  });
  return picture;
}

}  // namespace tetwarp
