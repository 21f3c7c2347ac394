/// @file palette.hpp
/// Pictures in few colors.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include <tetwarp/make.hpp>

namespace tetwarp {

using Color = std::array<std::uint8_t, 3>;

/// A part of a picture [pixel].
struct PictureBox {
  int left = 0, top = 0, width = 0, height = 0;
};

/// A picture as indices into a palette.
struct IndexedPicture {
  std::vector<Color> palette;         ///< at most 256 colors
  std::vector<std::uint8_t> indices;  ///< [row][column]
};

/// Chooses the colors that suit a part of a picture, and the nearest of them for each pixel.
///
/// Median cut by variance: the box of colors with the largest sum of squared distances from its
/// mean is divided at its mean, across the axis on which these distances are largest, until there
/// are 256. Colors are counted at 6 bits per channel.
/// Source: X. Wu, "Efficient Statistical Computations for Optimal Color Quantization", 1991 (the
/// choice of boxes by variance).
IndexedPicture index_picture(const Image& image, const PictureBox& box);

}  // namespace tetwarp
