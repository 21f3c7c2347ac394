#include <algorithm>
#include <cmath>

#include "bench/peers/avx512_sample.hpp"
#include "bench/peers/peer.hpp"

namespace tetwarp::bench {
namespace {
/// Row (j, k): its part inside the source is sampled, the rest is zero.
void sample_row(const AffineJob& job, const Sampler16& sampler, std::int64_t j, std::int64_t k) {
  float base[3], step[3];
  double low = 0, high = static_cast<double>(job.output_dims[0] - 1);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto& map = job.source_from_output[axis];
    const double start = map[1] * static_cast<double>(j) + map[2] * static_cast<double>(k) + map[3];
    base[axis] = static_cast<float>(start);
    step[axis] = static_cast<float>(map[0]);
    const double from = -0.5 - start, to = static_cast<double>(job.source_dims[axis]) - 0.5 - start;
    if (std::abs(map[0]) < 1e-12) {
      if (from > 0 || to < 0) high = -1;
      continue;
    }
    low = std::max(low, std::min(from / map[0], to / map[0]));
    high = std::min(high, std::max(from / map[0], to / map[0]));
  }
  int begin = static_cast<int>(std::ceil(low)), end = static_cast<int>(std::floor(high)) + 1;
  if (low > high || begin >= end) begin = end = 0;
  const std::int64_t dims = job.output_dims[0];
  float* const row = static_cast<float*>(job.output) + (k * job.output_dims[1] + j) * dims;
  std::fill(row, row + begin, 0.0f);
  std::fill(row + end, row + dims, 0.0f);
  sample_row16(sampler, base, step, begin, end, row);
}
}  // namespace

void sample_affine_avx512(const AffineJob& job, RowOrder order, int threads) {
  const Sampler16 sampler(
      static_cast<const float*>(job.source),
      {static_cast<int>(job.source_dims[0]), static_cast<int>(job.source_dims[1]),
       static_cast<int>(job.source_dims[2])});
  const std::int64_t width = order == RowOrder::bundles ? 16 : 32;
  const std::int64_t height = order == RowOrder::bundles ? 16 : 1;
  const std::int64_t rows = job.output_dims[1], slices = job.output_dims[2];
  const std::int64_t across = (rows + width - 1) / width;
  const std::int64_t blocks = across * ((slices + height - 1) / height);
#pragma omp parallel for schedule(dynamic) num_threads(threads)
  for (std::int64_t b = 0; b < blocks; ++b) {
    const std::int64_t first_j = b % across * width, first_k = b / across * height;
    for (std::int64_t k = first_k; k < std::min(first_k + height, slices); ++k) {
      for (std::int64_t j = first_j; j < std::min(first_j + width, rows); ++j) {
        sample_row(job, sampler, j, k);
      }
    }
  }
}

}  // namespace tetwarp::bench
