/// @file nifti.hpp
/// NIfTI files: grid, samples, and what else their headers say.
///
/// NIfTI's world is RAS, and so are its components. The order of the components of a symmetric
/// tensor (intent SYMMATRIX) is xx xy yy xz yz zz in NIfTI; a Volume has VTK's order, xx yy zz xy
/// yz xz. Readers and writers convert.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include <tetwarp/axes.hpp>
#include <tetwarp/io_export.hpp>
#include <tetwarp/volume.hpp>

namespace tetwarp {

/// What the header of a NIfTI file says about an array beside grid and samples. VTKHDF files keep
/// it as attributes `tetwarp_nifti_...` of the array; see docs/formats.md.
struct NiftiFacts {
  int sform_code = 1;                   ///< 0: the sform is not used
  int qform_code = 1;                   ///< 0: the qform is not used
  int xyzt_units = 2;                   ///< of length and time; 2: mm
  int intent_code = 0;                  ///< 1005 SYMMATRIX, 1006 DISPVECT, 1007 VECTOR ...
  std::array<double, 3> intent_p = {};  ///< parameters of the intent
  std::string intent_name = {};         ///< at most 15 bytes
  std::string description = {};         ///< `descrip`, at most 79 bytes
  Axes component_axes = Axes::ras;      ///< of vectors and tensors in the file
  double cal_min = 0;                   ///< values that viewers draw black and white; equal: none
  double cal_max = 0;
  double time_step = 1;  ///< `pixdim[4]` of an image of one step, in the header's unit of time

  bool operator==(const NiftiFacts&) const = default;
};

/// Intent of displacement fields. ITK takes them as RAS and turns them to LPS, which it does with
/// no other intent.
inline constexpr int nifti_displacement_intent = 1006;

/// Components of a displacement field for ITK on a grid: 2 of a single slice across the third axis
/// of the world, which ITK reads as a 2D image, else 3. @see ArrayHeader::is_itk_field
TETWARP_IO_EXPORT int itk_components(const Grid& grid);

/// Facts for an array without a file: coded as scanner coordinates in mm; six components are a
/// symmetric tensor, any other number above one is a vector.
TETWARP_IO_EXPORT NiftiFacts default_nifti_facts(int components);

/// Reads a step of a NIfTI file: NIfTI-1 or NIfTI-2, plain or gzip, of a pair .hdr and .img either
/// name. The affine map (sform, else qform) becomes the grid, in NIfTI's world: RAS, in the
/// header's unit. With scl_slope and scl_inter other than 1 and 0 samples become float32 (float64
/// stays). `dim[5]` gives the components, `dim[4]` the steps. A symmetric tensor gets VTK's order
/// of components.
/// @param axes  axes of the file's components, which ITK writes as LPS: those of vectors (three
///              components) and tensors (SYMMATRIX, or nine) are turned to RAS. The grid comes from
///              the header and is RAS in any case
/// @param step  from 0
/// @throws IoError if lps is asked for samples that are neither, or not float32 or float64
TETWARP_IO_EXPORT Volume read_nifti(const std::string& path,
                                    Axes axes = Axes::ras,
                                    std::int64_t step = 0);

/// Reads what else the header says. The code of a qform that differs from the sform by more than
/// 0.01 voxel is 0, because the grid is the sform's. @param axes  as given to read_nifti()
TETWARP_IO_EXPORT NiftiFacts read_nifti_facts(const std::string& path, Axes axes = Axes::ras);

/// Writes a NIfTI-1 file, or NIfTI-2 where an axis has more than 32767 voxels. The sform holds the
/// grid, and so does the qform when direction is a rotation. With facts, a form whose code is 0 is
/// left out if the other one, or the voxel sizes alone, hold the grid. Symmetric tensors get
/// NIfTI's order.
/// @param axes   axes of the components in the file, as of read_nifti(); the grid's are RAS. With
///               lps a displacement (intent DISPVECT) becomes a VECTOR, because ITK would turn it
///               once more
/// @param facts  nothing: default_nifti_facts()
TETWARP_IO_EXPORT void write_nifti(const std::string& path,
                                   const Volume& volume,
                                   Axes axes = Axes::ras,
                                   const std::optional<NiftiFacts>& facts = {});

}  // namespace tetwarp
