/// @file floors.cpp
/// The sampling loop, compiled once per vector instruction set, and the copies.
#include "bench/measure/floors.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>

#include "bench/measure/buffer.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/measure/floors.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "bench/measure/affine_row-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp::bench {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

std::int64_t sample_block(const AffineJob& job, const RowBlock& rows) {
  std::int64_t sampled = 0;
  for (std::int64_t k = rows.begin_k; k < rows.end_k; ++k) {
    for (std::int64_t j = rows.begin_j; j < rows.end_j; ++j) {
      sampled += job.type == PixelType::uint8     ? sample_row<std::uint8_t>(job, j, k)
                 : job.type == PixelType::int16   ? sample_row<std::int16_t>(job, j, k)
                 : job.type == PixelType::float32 ? sample_row<float>(job, j, k)
                                                  : sample_row<double>(job, j, k);
    }
  }
  return sampled;
}

/// Copies past the cache; both ends at multiples of 64 bytes.
void stream_copy(const std::byte* from, std::byte* to, std::size_t size) {
  const hn::ScalableTag<float> d;
  const auto* source = reinterpret_cast<const float*>(from);
  auto* target = reinterpret_cast<float*>(to);
  for (std::size_t i = 0; i < size / sizeof(float); i += hn::Lanes(d)) {
    hn::Stream(hn::Load(d, source + i), d, target + i);
  }
}

const char* target_name() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp::bench
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tetwarp::bench {

HWY_EXPORT(sample_block);
HWY_EXPORT(stream_copy);
HWY_EXPORT(target_name);

double copy_bandwidth(int threads) {
  constexpr std::size_t size = std::size_t{512} << 20, piece = std::size_t{1} << 20;
  const Buffer from(size), to(size);
  const auto seconds = [&](auto&& copy) {
    const auto start = std::chrono::steady_clock::now();
#pragma omp parallel for schedule(static) num_threads(threads)
    for (std::size_t at = 0; at < size; at += piece) copy(from.data() + at, to.data() + at, piece);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  seconds([](std::byte* a, std::byte* b, std::size_t n) {
    std::memset(a, 1, n);
    std::memset(b, 2, n);
  });
  double best = 1e30;
  for (int repetition = 0; repetition < 7; ++repetition) {
    best = std::min(
        best, seconds([](std::byte* a, std::byte* b, std::size_t n) { std::memcpy(b, a, n); }));
    best = std::min(best, seconds([](std::byte* a, std::byte* b, std::size_t n) {
                      HWY_DYNAMIC_DISPATCH(stream_copy)(a, b, n);
                    }));
  }
  return 2.0 * static_cast<double>(size) / best;
}

AffineRows turned_about_middle(const Grid& source, const Grid& output, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  // Transposes of the turns: about x first, undone last.
  AffineRows rows{{{c, s * c, s * s, 0}, {-s, c * c, c * s, 0}, {0, -s, c, 0}}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    rows[axis][3] = static_cast<double>(source.dims[axis] - 1) / 2;
    for (std::size_t a = 0; a < 3; ++a) {
      rows[axis][3] -= rows[axis][a] * static_cast<double>(output.dims[a] - 1) / 2;
    }
  }
  return rows;
}

std::int64_t sample_affine(const AffineJob& job, RowOrder order, int threads) {
  const std::int64_t width = order == RowOrder::bundles ? 16 : 32;
  const std::int64_t height = order == RowOrder::bundles ? 16 : 1;
  const std::int64_t rows = job.output_dims[1], slices = job.output_dims[2];
  const std::int64_t across = (rows + width - 1) / width;
  const std::int64_t blocks = across * ((slices + height - 1) / height);
  std::int64_t sampled = 0;
#pragma omp parallel for schedule(dynamic) num_threads(threads) reduction(+ : sampled)
  for (std::int64_t b = 0; b < blocks; ++b) {
    const std::int64_t j = b % across * width, k = b / across * height;
    const RowBlock block{j, std::min(j + width, rows), k, std::min(k + height, slices)};
    sampled += HWY_DYNAMIC_DISPATCH(sample_block)(job, block);
  }
  return sampled;
}

const char* vector_target() {
  return HWY_DYNAMIC_DISPATCH(target_name)();
}

}  // namespace tetwarp::bench
#endif  // HWY_ONCE
