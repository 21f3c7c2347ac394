/// @file test_staging.cpp
/// How large copies are divided into pieces, and copies past the caches.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernels/base/host_tasks.hpp"
#include "kernels/base/slice_pieces.hpp"

namespace tetwarp::test {
namespace {
constexpr std::size_t most = 64;

/// The bytes of a part, in order.
std::vector<std::size_t> bytes_of(const SliceBytes& part) {
  std::vector<std::size_t> bytes;
  for (std::size_t k = 0; k < part.slices; ++k) {
    for (std::size_t b = 0; b < part.row * part.rows; ++b) {
      bytes.push_back(k * part.row * part.pitch + b);
    }
  }
  return bytes;
}

class Pieces : public ::testing::TestWithParam<SliceBytes> {};
INSTANTIATE_TEST_SUITE_P(Parts,
                         Pieces,
                         ::testing::Values(SliceBytes{1, 1, 1, 1},
                                           SliceBytes{0, 3, 3, 4},
                                           SliceBytes{31, 1, 1, 1},
                                           SliceBytes{32, 3, 3, 7},
                                           SliceBytes{1025, 1, 1, 1},
                                           SliceBytes{3, 5, 9, 33},
                                           SliceBytes{8, 8, 10, 5},
                                           SliceBytes{33, 7, 11, 5},
                                           SliceBytes{7, 1, 2, 500}));

TEST_P(Pieces, HaveEveryByteOnceAndInOrder) {
  for (const std::size_t takers : {1, 3, 8}) {
    std::vector<std::size_t> bytes;
    for (const SlicePiece& piece : pieces_of(GetParam(), most, takers)) {
      EXPECT_GT(piece.size(), 0u);
      EXPECT_LE(piece.size(), most);
      for (std::size_t k = 0; k < piece.slices; ++k) {
        for (std::size_t b = 0; b < piece.run; ++b) {
          bytes.push_back(piece.offset + k * GetParam().row * GetParam().pitch + b);
        }
      }
    }
    EXPECT_EQ(bytes, bytes_of(GetParam()));
  }
}

/// Takers of one piece each end together but for the last, smallest piece.
TEST(PiecesOfAnArray, GetSmallerTowardsItsEnd) {
  constexpr std::size_t size = std::size_t{31} << 20, largest = std::size_t{2} << 20;
  const std::vector<SlicePiece> pieces = pieces_of({size, 1, 1, 1}, largest, 8);

  EXPECT_EQ(pieces.front().size(), largest);
  EXPECT_LE(pieces.back().size(), largest / 8);
  for (std::size_t p = 1; p < pieces.size(); ++p) {
    EXPECT_LE(pieces[p].size(), pieces[p - 1].size());
  }
}

TEST(StreamCopy, WritesItsBytesAndNoOthers) {
  for (const std::size_t size : {0, 1, 31, 63, 64, 65, 129, 1025}) {
    for (const std::size_t at : {0, 1, 16, 63}) {
      std::vector<std::byte> from(size + 3), to(at + size + 64, std::byte{0xee});
      for (std::size_t b = 0; b < from.size(); ++b) from[b] = static_cast<std::byte>(b % 251);
      std::vector<std::byte> expected = to;
      std::copy_n(from.begin() + 3, size, expected.begin() + static_cast<std::ptrdiff_t>(at));

      stream_copy(from.data() + 3, to.data() + at, size);

      EXPECT_EQ(to, expected) << size << " bytes at " << at;
    }
  }
}
}  // namespace
}  // namespace tetwarp::test
