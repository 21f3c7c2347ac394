/// @file row_transform-inl.hpp
/// Rows of averaged, reoriented or scaled samples. Included once per vector instruction set.
#if defined(TETWARP_ROW_TRANSFORM_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_TRANSFORM_INL
#undef TETWARP_ROW_TRANSFORM_INL
#else
#define TETWARP_ROW_TRANSFORM_INL
#endif

#include <hwy/highway.h>

#include "host/warp/cpu/rows/row_source-inl.hpp"
#include "kernels/warp/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {

/// Writes the runs of row (j, k) whose tetrahedra have a transform, with the bits of
/// store_transformed_voxel(); leaves out the others, and all of pixel types that can_blend
/// excludes. Defined in row_transform_cpu.cpp, a file of its own because the code for all pixel
/// types and instruction sets takes long to compile.
/// @param job    a RasterJob of pixel type `type`; its volume is the row, from voxel 0 of the
///               line's cell 0 on
/// @param shape  of the job's source
void write_transform_row(PixelType type,
                         const RasterGeometry& job,
                         const SourceShape& shape,
                         const RowSource* sources,
                         const RowRun* runs,
                         int count,
                         int j,
                         int k);

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
