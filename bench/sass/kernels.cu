/// @file kernels.cu
/// The kernels whose machine instructions `./dev sass` counts.
#include <cstdint>

#include "bench/measure/affine_device.cuh"
#include "kernels/warp/cuda/cell_class.cuh"
#include "kernels/warp/cuda/cell_interior.cuh"
#include "kernels/warp/cuda/cell_raster.cuh"
#include "kernels/warp/cuda/cell_tested.cuh"

namespace tetwarp {
template __global__ void cell_raster_kernel<float, false>(RasterJob<float>);
template __global__ void cell_raster_kernel<std::uint8_t, false>(RasterJob<std::uint8_t>);
template __global__ void cell_class_kernel<float>(CellWorkBody<float>, CellLists);
template __global__ void cell_interior_kernel<float>(RasterJob<float>,
                                                     const InteriorCell*,
                                                     const CellListCounts*);
template __global__ void cell_interior_kernel<std::uint8_t>(RasterJob<std::uint8_t>,
                                                            const InteriorCell*,
                                                            const CellListCounts*);
template __global__ void cell_tested_kernel<float>(RasterJob<float>, CellLists, bool);

namespace bench {
template __global__ void affine_kernel<Tile<8, 8>, true, float>(
    AffineDeviceJob<float, LinearSource<float>>);
}  // namespace bench
}  // namespace tetwarp
