/// @file transform_file.hpp
/// Displacement fields and affine transforms of ITK, ANTs and NiftyReg.
#pragma once
#include <optional>
#include <string>

#include <tetwarp/axes.hpp>
#include <tetwarp/error.hpp>
#include <tetwarp/io_export.hpp>
#include <tetwarp/resample.hpp>

namespace tetwarp {

/// A transform in RAS, and what its file was taken for.
struct TransformFile {
  Transform transform;
  std::string
      convention;  ///< for a line to print: "displacements along LPS axes in mm (intent ...)"
};

/// True for what read_transform() reads: names that end in .tfm, .txt or .mat, images (NIfTI,
/// NRRD, MetaImage) of three components, and volumes with an array `tetwarp_displacement`.
TETWARP_IO_EXPORT bool is_transform_file(const std::string& path);

/// Reads a transform from positions of the output to positions in the source, as resamplers take
/// it, and turns it to RAS.
///
/// - ITK's text (.tfm, .txt) and MATLAB files (.mat): affine, rigid, similarity, scale and
///   translation transforms and composites of these, in LPS
/// - NIfTI displacement fields. The intent code states the axes of the components: VECTOR is LPS
/// and mm
///   (ITK, ANTs), DISPVECT is RAS in the header's unit, VECTOR named NREG_TRANS is NiftyReg's:
///   displacements or positions in RAS. Any other needs `axes`
/// - NRRD files and MetaImages of three components: LPS, as ITK and 3D Slicer write them
/// - the array `tetwarp_displacement` of a VTKHDF volume, as `tetwarp warp` writes it
/// @param axes  of the components of a field in an image, instead of those that its format states
/// @throws IoError  on other transforms, files that do not tell their convention, damaged files
TETWARP_IO_EXPORT TransformFile read_transform(const std::string& path,
                                               const std::optional<Axes>& axes = {});

}  // namespace tetwarp
