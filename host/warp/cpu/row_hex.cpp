/// @file row_hex.cpp
#include "host/warp/cpu/row_hex.hpp"

#include <bit>

namespace tetwarp {

template <class T>
void sample_row_hex(const RasterJob<T>& job,
                    std::int64_t t,
                    const int* corner,
                    unsigned bits,
                    int j,
                    int k,
                    std::int64_t row) {
  const HexMap map = hex_map_of(job, t);
  for (; bits != 0; bits &= bits - 1) {
    const int i = std::countr_zero(bits);
    const int x[3] = {corner[0] + i, corner[1] + j, corner[2] + k};
    store_hex_voxel<true>(job, job.setups[t], map, x, row + i);
  }
}

template void sample_row_hex(
    const RasterJob<std::uint8_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void sample_row_hex(
    const RasterJob<std::int8_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void sample_row_hex(
    const RasterJob<std::uint16_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void sample_row_hex(
    const RasterJob<std::int16_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void sample_row_hex(
    const RasterJob<std::uint32_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void sample_row_hex(
    const RasterJob<std::int32_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void sample_row_hex(
    const RasterJob<std::uint64_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void sample_row_hex(
    const RasterJob<std::int64_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void sample_row_hex(
    const RasterJob<float>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void sample_row_hex(
    const RasterJob<double>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);

}  // namespace tetwarp
