/// @file test_volume_range.cpp
/// The least and largest sample of each component.
#include <cstdint>
#include <limits>
#include <vector>

#include "kernels/warp/sample/volume_range.hpp"
#include "tests/support/each_exec.hpp"

namespace tetwarp::test {
namespace {
template <class Exec>
class VolumeRange : public EachExec<Exec> {
 protected:
  template <class T>
  std::vector<ArithmeticOf<T>> run(const std::vector<T>& samples, int components) {
    const SourceView<T> source = {this->upload(samples).data,
                                  {static_cast<int>(samples.size()) / components, 1, 1},
                                  components};
    return volume_range(this->exec(), source);
  }
};
TYPED_TEST_SUITE(VolumeRange, Execs, ExecNames);

TYPED_TEST(VolumeRange, ReadsEverySample) {
  for (const std::size_t size : {1u, 4095u, 4096u, 4097u, 10000u}) {
    for (const std::size_t at : {std::size_t{0}, size / 2, size - 1}) {
      std::vector<std::int16_t> samples(size, 7);
      samples[at] = -300;
      EXPECT_EQ(this->run(samples, 1).front(), -300);
      samples[at] = 300;
      EXPECT_EQ(this->run(samples, 1).back(), 300);
    }
  }
}

TYPED_TEST(VolumeRange, KeepsComponentsApart) {
  std::vector<std::uint8_t> samples;
  for (int v = 0; v < 5000; ++v) {
    samples.push_back(static_cast<std::uint8_t>(v % 50));
    samples.push_back(static_cast<std::uint8_t>(100 + v % 3));
  }

  EXPECT_EQ(this->run(samples, 2), (std::vector<float>{0, 49, 100, 102}));
}

TYPED_TEST(VolumeRange, LeavesOutNaN) {
  using Limits = std::numeric_limits<double>;
  const double nan = Limits::quiet_NaN(), infinity = Limits::infinity();

  EXPECT_EQ(this->run(std::vector<double>{nan, 3, nan, -1, 2, nan}, 1),
            (std::vector<double>{-1, 3}));
  EXPECT_EQ(this->run(std::vector<double>{1, infinity}, 1), (std::vector<double>{1, infinity}));
  EXPECT_EQ(this->run(std::vector<double>{nan, nan}, 1),
            (std::vector<double>{infinity, -infinity}));
}
}  // namespace
}  // namespace tetwarp::test
