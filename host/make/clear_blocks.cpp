/// @file clear_blocks.cpp
/// Ranges of the samples of blocks.
#include "host/make/clear_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/base/parallel.hpp"
#include "host/make/transfer.hpp"

namespace tetwarp {

ClearBlocks clear_blocks(const Volume& volume, const TransferFunction& colors) {
  constexpr int edge = ClearBlocks::edge;
  const auto& dims = volume.grid.dims;
  ClearBlocks blocks;
  for (std::size_t axis = 0; axis < 3; ++axis) blocks.dims[axis] = (dims[axis] + edge - 1) / edge;
  const std::int64_t row = blocks.dims[0], slice = row * blocks.dims[1];
  blocks.is_clear.resize(static_cast<std::size_t>(slice * blocks.dims[2]));
  parallel_for(thread_count(0), std::ssize(blocks.is_clear), [&](std::int64_t b) {
    // With the first voxels of the next blocks, with which the last ones are interpolated.
    std::array<std::int64_t, 3> begin{b % row * edge, b % slice / row * edge, b / slice * edge};
    double low = std::numeric_limits<double>::infinity(), high = -low;
    const auto include = [&](double value) {
      low = std::min(low, value);
      high = std::max(high, value);
    };
    for (std::int64_t k = begin[2]; k < std::min(begin[2] + edge + 1, dims[2]); ++k) {
      for (std::int64_t j = begin[1]; j < std::min(begin[1] + edge + 1, dims[1]); ++j) {
        for (std::int64_t i = begin[0]; i < std::min(begin[0] + edge + 1, dims[0]); ++i) {
          const double value = value_at(volume, (k * dims[1] + j) * dims[0] + i);
          include(std::isnan(value) ? colors.points.front().value : value);
        }
      }
    }
    blocks.is_clear[static_cast<std::size_t>(b)] = is_clear(colors, low, high);
  });
  return blocks;
}

}  // namespace tetwarp
