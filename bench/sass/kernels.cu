/// @file kernels.cu
/// The kernels whose machine instructions `./dev sass` counts.
#include <cstdint>

#include "bench/measure/affine_device.cuh"
#include "kernels/warp/cuda/cell_group.cuh"
#include "kernels/warp/cuda/cell_raster.cuh"

namespace tetwarp {
template __global__ void cell_raster_kernel<float, false>(RasterJob<float>);
template __global__ void cell_raster_kernel<std::uint8_t, false>(RasterJob<std::uint8_t>);
template __global__ void cell_group_kernel<float, float>(RasterJob<float>,
                                                         int,
                                                         std::uint32_t*,
                                                         std::int32_t*);
template __global__ void cell_group_kernel<float, PackedSample<float>>(RasterJob<float>,
                                                                       int,
                                                                       std::uint32_t*,
                                                                       std::int32_t*);
template __global__ void cell_group_kernel<std::uint8_t, PackedSample<std::uint8_t>>(
    RasterJob<std::uint8_t>, int, std::uint32_t*, std::int32_t*);

namespace bench {
template __global__ void affine_kernel<Tile<8, 8>, true, float>(
    AffineDeviceJob<float, LinearSource<float>>);
}  // namespace bench
}  // namespace tetwarp
