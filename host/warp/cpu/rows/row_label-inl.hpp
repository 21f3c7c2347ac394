/// @file row_label-inl.hpp
/// Rows of the filter for labels. Included once per vector instruction set.
#if defined(TETWARP_ROW_LABEL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_LABEL_INL
#undef TETWARP_ROW_LABEL_INL
#else
#define TETWARP_ROW_LABEL_INL
#endif

#include <hwy/highway.h>

#include "host/warp/cpu/rows/row_source-inl.hpp"
#include "kernels/warp/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {

/// Writes the voxels of row (j, k) with the labels of label_at().
/// @param type   of pixels, an integer
/// @param job    a RasterJob of this type; its volume is the row, from voxel 0 of the line's cell 0
///               on
/// @param shape  of the job's source
/// @param runs   sorted by cell, none of RowKind::copied; their order within a cell is changed
void write_label_row(PixelType type,
                     const RasterGeometry& job,
                     const SourceShape& shape,
                     const RowSource* sources,
                     RowRun* runs,
                     int count,
                     int j,
                     int k);

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
