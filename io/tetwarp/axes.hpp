/// @file axes.hpp
/// World axes of files: along which axes positions and components are given.
#pragma once
#include <span>

#include <tetwarp/io_export.hpp>
#include <tetwarp/names.hpp>

namespace tetwarp {

/// World axes of a file of a patient. The two differ by half a turn about the third axis: x and y
/// have the other sign.
enum class Axes {
  ras,  ///< to the right, anterior, superior: NIfTI, nibabel, FSL, FreeSurfer
  lps   ///< to the left, posterior, superior: DICOM, ITK, SimpleITK, ANTs, files of 3D Slicer
};
template <>
TETWARP_IO_EXPORT std::span<const EnumName<Axes>> names_of();

}  // namespace tetwarp
