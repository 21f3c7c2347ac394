/// @file row_transformed.cpp
#include "host/warp/cpu/row_transformed.hpp"

#include <bit>

#include "kernels/warp/voxel_transform.hpp"

namespace tetwarp {

template <class T>
void write_row_transformed(const RasterJob<T>& job,
                           std::int64_t t,
                           const int* corner,
                           unsigned bits,
                           int j,
                           int k,
                           std::int64_t row) {
  for (; bits != 0; bits &= bits - 1) {
    const int i = std::countr_zero(bits);
    store_transformed_voxel(job, t, {corner, i, j, k, row + i});
  }
}

template <class T>
void write_outside_transformed(
    const RasterJob<T>& job, const int* corner, int i, int j, int k, std::int64_t voxel) {
  store_transformed_outside(job, {corner, i, j, k, voxel});
}

template void write_row_transformed(
    const RasterJob<std::uint8_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void write_outside_transformed(
    const RasterJob<std::uint8_t>&, const int*, int, int, int, std::int64_t);
template void write_row_transformed(
    const RasterJob<std::int8_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void write_outside_transformed(
    const RasterJob<std::int8_t>&, const int*, int, int, int, std::int64_t);
template void write_row_transformed(
    const RasterJob<std::uint16_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void write_outside_transformed(
    const RasterJob<std::uint16_t>&, const int*, int, int, int, std::int64_t);
template void write_row_transformed(
    const RasterJob<std::int16_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void write_outside_transformed(
    const RasterJob<std::int16_t>&, const int*, int, int, int, std::int64_t);
template void write_row_transformed(
    const RasterJob<std::uint32_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void write_outside_transformed(
    const RasterJob<std::uint32_t>&, const int*, int, int, int, std::int64_t);
template void write_row_transformed(
    const RasterJob<std::int32_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void write_outside_transformed(
    const RasterJob<std::int32_t>&, const int*, int, int, int, std::int64_t);
template void write_row_transformed(
    const RasterJob<std::uint64_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void write_outside_transformed(
    const RasterJob<std::uint64_t>&, const int*, int, int, int, std::int64_t);
template void write_row_transformed(
    const RasterJob<std::int64_t>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void write_outside_transformed(
    const RasterJob<std::int64_t>&, const int*, int, int, int, std::int64_t);
template void write_row_transformed(
    const RasterJob<float>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void write_outside_transformed(
    const RasterJob<float>&, const int*, int, int, int, std::int64_t);
template void write_row_transformed(
    const RasterJob<double>&, std::int64_t, const int*, unsigned, int, int, std::int64_t);
template void write_outside_transformed(
    const RasterJob<double>&, const int*, int, int, int, std::int64_t);

}  // namespace tetwarp
