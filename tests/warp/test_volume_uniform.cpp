/// @file test_volume_uniform.cpp
/// Every sample within the reach found for a block has the same bits.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "kernels/warp/volume_uniform.hpp"
#include "tests/support/each_exec.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/stages.hpp"

namespace tetwarp::test {
namespace {
/// A volume of one value that owns its samples.
template <class T>
struct Samples {
  int dims[3];
  int components;
  std::vector<T> data;

  Samples(int nx, int ny, int nz, T value, int count = 1)
      : dims{nx, ny, nz},
        components(count),
        data(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) *
                 static_cast<std::size_t>(nz * count),
             value) {}
  T& at(int i, int j, int k, int c = 0) {
    return data[static_cast<std::size_t>(((k * dims[1] + j) * dims[0] + i) * components + c)];
  }
};

/// One tetrahedron whose box is the box from (low, low, low) to (high, high, high).
std::vector<Node> box_nodes(double low, double high) {
  return {node_at(low, low, low), node_at(high, low, high), node_at(low, high, high),
          node_at(high, high, low)};
}

template <class Exec>
class VolumeUniform : public EachExec<Exec> {
 protected:
  struct Found {
    std::vector<std::uint8_t> reach;
    std::int64_t wide = 0;
  };

  template <class T>
  Found run(const Samples<T>& samples, const std::vector<Node>& rest = box_nodes(0, 100)) {
    SourceView<T> source = {this->upload(samples.data).data,
                            {samples.dims[0], samples.dims[1], samples.dims[2]},
                            samples.components};
    const std::int64_t blocks = make_uniform_map(source).block_count();
    const auto reach = this->template zeros<std::uint8_t>(blocks);
    const auto wide = this->template zeros<std::int64_t>(1);
    volume_uniform(this->exec(), source,
                   View<const std::int32_t>(this->upload(std::vector<std::int32_t>{0, 1, 2, 3})),
                   View<const Node>(this->upload(rest)), reach,
                   this->template zeros<std::uint8_t>(blocks), wide);
    return {this->download(reach), this->download(wide).front()};
  }
};
TYPED_TEST_SUITE(VolumeUniform, Execs, ExecNames);

using Bytes = std::vector<std::uint8_t>;

TYPED_TEST(VolumeUniform, ReachesFarthestWhereTheSourceHoldsOneValue) {
  EXPECT_EQ(this->run(Samples<float>(40, 33, 17, 1.5f)).reach, Bytes(5 * 5 * 3, longest_reach));
  EXPECT_EQ(this->run(Samples<std::uint8_t>(8, 8, 8, 7)).reach, Bytes(1, longest_reach));
  EXPECT_EQ(this->run(Samples<double>(1, 9, 1, 0.0)).reach, Bytes(2, longest_reach));
}

/// A row of blocks along i, one odd sample in the fifth. Behind the end of the source is anything.
TYPED_TEST(VolumeUniform, CountsTheBlocksToTheNextOddSample) {
  Samples<std::int16_t> samples(72, 8, 8, 3);
  samples.at(39, 7, 7) = 4;

  const auto found = this->run(samples);

  EXPECT_EQ(found.reach, (Bytes{4, 3, 2, 1, 0, 5, 5, 5, 5}));
  EXPECT_EQ(found.wide, 7);
}

TYPED_TEST(VolumeUniform, ReadsEverySampleOfABlock) {
  for (int v = 0; v < 512; ++v) {
    Samples<std::uint8_t> samples(8, 8, 8, 3);
    samples.data[static_cast<std::size_t>(v)] = 2;
    EXPECT_EQ(this->run(samples).reach, Bytes{0}) << v;
  }
}

TYPED_TEST(VolumeUniform, SeparatesBlocksOfDifferentValues) {
  Samples<float> samples(48, 8, 8, 3);
  for (int i = 24; i < 48; ++i) {
    for (int v = 0; v < 64; ++v) samples.at(i, v % 8, v / 8) = 4;
  }

  EXPECT_EQ(this->run(samples).reach, (Bytes{3, 2, 1, 5, 5, 5}));
}

TYPED_TEST(VolumeUniform, LooksAtEveryComponent) {
  Samples<std::uint16_t> samples(24, 8, 8, 3, 3);
  for (int v = 0; v < 24 * 64; ++v) samples.data[static_cast<std::size_t>(3 * v + 1)] = 9;
  EXPECT_EQ(this->run(samples).reach, Bytes(3, longest_reach));

  samples.at(23, 0, 5, 2) = 4;
  EXPECT_EQ(this->run(samples).reach, (Bytes{2, 1, 0}));
}

/// a + f (b - a) is not a for these, or is only as a number.
TYPED_TEST(VolumeUniform, NeverFillsWhatInterpolationMayChange) {
  using Limits = std::numeric_limits<float>;
  for (const float value : {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity(), -0.0f}) {
    EXPECT_EQ(this->run(Samples<float>(16, 8, 8, value)).reach, (Bytes{0, 0})) << value;
    Samples<float> one(16, 8, 8, 0.0f);
    one.at(3, 3, 3) = value;
    EXPECT_EQ(this->run(one).reach, (Bytes{0, longest_reach})) << value;
    EXPECT_EQ(this->run(Samples<double>(16, 8, 8, value)).reach, (Bytes{0, 0})) << value;
  }
  for (const float value : {Limits::max(), Limits::lowest(), Limits::denorm_min()}) {
    EXPECT_EQ(this->run(Samples<float>(16, 8, 8, value)).reach, Bytes(2, longest_reach)) << value;
  }
}

/// Blocks that no tetrahedron samples are not read, except for the neighbors of sampled ones.
TYPED_TEST(VolumeUniform, LooksOnlyWhereTheMeshIs) {
  const Samples<float> samples(64, 8, 8, 1.5f);
  EXPECT_EQ(this->run(samples, box_nodes(2, 7)).reach, (Bytes{2, 1, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(this->run(samples, box_nodes(-9, -3)).reach, (Bytes{1, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(this->run(samples, box_nodes(-90, -70)).reach, Bytes(8, 0));
  EXPECT_EQ(this->run(samples, box_nodes(90, 99)).reach, Bytes(8, 0));
}

/// Random spots in a volume of blocks of two values, against the definition.
TYPED_TEST(VolumeUniform, IsTheDefinition) {
  Samples<std::int16_t> samples(90, 61, 77, 5);
  for (int v = 0; v < 30; ++v) {
    const auto random = [&](int axis) {
      return static_cast<int>(scenes::uniform(73, static_cast<std::uint64_t>(4 * v + axis)) *
                              samples.dims[axis]);
    };
    samples.at(random(0), random(1), random(2)) = static_cast<std::int16_t>(v % 3);
  }
  const int blocks[3] = {12, 8, 10};

  const auto reach = this->run(samples).reach;

  const auto holds_one_value = [&](const int* block, int reach) {
    int begin[3], end[3];
    for (int axis = 0; axis < 3; ++axis) {
      begin[axis] = 8 * block[axis];
      end[axis] = std::min(8 * (block[axis] + reach + 1), samples.dims[axis]);
    }
    for (int k = begin[2]; k < end[2]; ++k) {
      for (int j = begin[1]; j < end[1]; ++j) {
        for (int i = begin[0]; i < end[0]; ++i) {
          if (samples.at(i, j, k) != samples.at(begin[0], begin[1], begin[2])) return false;
        }
      }
    }
    return true;
  };
  std::size_t b = 0;
  int seen[longest_reach + 1] = {};
  for (int bk = 0; bk < blocks[2]; ++bk) {
    for (int bj = 0; bj < blocks[1]; ++bj) {
      for (int bi = 0; bi < blocks[0]; ++bi, ++b) {
        const int block[3] = {bi, bj, bk};
        int expected = 0;
        while (expected < longest_reach && holds_one_value(block, expected)) ++expected;
        ASSERT_EQ(reach[b], expected) << b;
        ++seen[expected];
      }
    }
  }
  for (const int count : seen) EXPECT_GT(count, 0);
}
}  // namespace
}  // namespace tetwarp::test
