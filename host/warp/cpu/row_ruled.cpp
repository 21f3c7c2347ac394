/// @file row_ruled.cpp
#include "host/warp/cpu/row_ruled.hpp"

#include <bit>

#include "kernels/warp/voxel_rule.hpp"

namespace tetwarp {

template <class T>
void write_row_ruled(const RasterJob<T>& job,
                     std::int64_t t,
                     const int* corner,
                     unsigned bits,
                     int j,
                     int k,
                     std::int64_t row) {
  for (; bits != 0; bits &= bits - 1) {
    const int i = std::countr_zero(bits);
    store_ruled(job, t, corner, i, j, k, row + i);
  }
}

template <class T>
void write_outside_ruled(
    const RasterJob<T>& job, const int* corner, int i, int j, int k, std::int64_t voxel) {
  store_outside_ruled(job, corner, i, j, k, voxel);
}

template void write_row_ruled(
    const RasterJob<std::uint8_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void write_outside_ruled(
    const RasterJob<std::uint8_t>&, const int*, int, int, int, std::int64_t);
template void write_row_ruled(
    const RasterJob<std::int8_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void write_outside_ruled(
    const RasterJob<std::int8_t>&, const int*, int, int, int, std::int64_t);
template void write_row_ruled(
    const RasterJob<std::uint16_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void write_outside_ruled(
    const RasterJob<std::uint16_t>&, const int*, int, int, int, std::int64_t);
template void write_row_ruled(
    const RasterJob<std::int16_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void write_outside_ruled(
    const RasterJob<std::int16_t>&, const int*, int, int, int, std::int64_t);
template void write_row_ruled(
    const RasterJob<std::uint32_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void write_outside_ruled(
    const RasterJob<std::uint32_t>&, const int*, int, int, int, std::int64_t);
template void write_row_ruled(
    const RasterJob<std::int32_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void write_outside_ruled(
    const RasterJob<std::int32_t>&, const int*, int, int, int, std::int64_t);
template void write_row_ruled(
    const RasterJob<std::uint64_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void write_outside_ruled(
    const RasterJob<std::uint64_t>&, const int*, int, int, int, std::int64_t);
template void write_row_ruled(
    const RasterJob<std::int64_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void write_outside_ruled(
    const RasterJob<std::int64_t>&, const int*, int, int, int, std::int64_t);
template void write_row_ruled(
    const RasterJob<float>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void write_outside_ruled(const RasterJob<float>&, const int*, int, int, int, std::int64_t);
template void write_row_ruled(
    const RasterJob<double>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void write_outside_ruled(
    const RasterJob<double>&, const int*, int, int, int, std::int64_t);

}  // namespace tetwarp
