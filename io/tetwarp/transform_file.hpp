/// @file transform_file.hpp
/// Displacement fields, affine transforms and splines of ITK, ANTs, NiftyReg and FSL.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/axes.hpp>
#include <tetwarp/error.hpp>
#include <tetwarp/field_reader.hpp>
#include <tetwarp/io_export.hpp>
#include <tetwarp/names.hpp>
#include <tetwarp/resample.hpp>

namespace tetwarp {

/// A transform in RAS, and what its file was taken for.
struct TransformFile {
  Transform transform;
  std::string
      convention;  ///< for a line to print: "displacements along LPS axes in mm (intent ...)"
  bool ends_with_field = false;  ///< what is beyond the field's grid has no place in the source
  /// One for each link of a chain, a single one for any other transform: true if the file says that
  /// the link leads from the source to the output, so that its inverse is meant. Empty: none does.
  std::vector<bool> is_inverted = {};
};

/// What the numbers of a warp field of FSL are.
enum class FslWarp {
  relative,  ///< displacements
  absolute   ///< positions
};
template <>
TETWARP_IO_EXPORT std::span<const EnumName<FslWarp>> names_of();

/// Choices of read_transform().
struct TransformReadOptions {
  /// Of the components of a field in an image, instead of those that its format states.
  std::optional<Axes> axes = {};
  /// Says that a NIfTI image is a warp field of FSL, and what its numbers are.
  std::optional<FslWarp> fsl = {};
  std::string image = {};  ///< file of the image to warp, to whose voxels fields of FSL lead
  /// As of VolumeReadOptions, for fields of which regions are read.
  std::string scratch = {};
  /// itk_factor() of the positions to transform: those of ITK's transforms are turned to them.
  /// Nothing: that of `image`; without either they are RAS in millimeters.
  std::optional<Point3> world = {};
  /// Of a displacement field with several steps; without it such a file is an error.
  std::optional<std::int64_t> step = {};
  /// Reads transforms whose inverse is meant; see TransformFile::is_inverted. Else they are an
  /// error.
  bool takes_inverted = false;
};

/// True for what read_transform() reads: names that end in .tfm, .txt or .mat, HDF5 files of ITK,
/// images (NIfTI, NRRD, MetaImage) of three components or, of a single slice, two, warp fields of
/// FSL, and volumes with an array `tetwarp_displacement`.
TETWARP_IO_EXPORT bool is_transform_file(const std::string& path,
                                         const TransformReadOptions& options = {});

/// A transform whose displacement fields are read in parts.
struct TransformParts {
  TransformFile file;               ///< its fields have grids, but no displacements
  std::vector<FieldReader> fields;  ///< one per link of the transform; of a field: it reads them
};

/// Steps of a displacement field in an image or a volume; 1 of any other transform.
TETWARP_IO_EXPORT std::int64_t transform_step_count(const std::string& path,
                                                    const TransformReadOptions& options = {});

/// Reads a transform from positions of the output to positions in the source, as resamplers take
/// it, and turns it to RAS. Those of two dimensions move nothing along the third axis, and are the
/// same in all planes across it.
///
/// - ITK's text (.tfm, .txt), MATLAB (.mat) and HDF5 files: affine, rigid, similarity, scale and
///   translation transforms, displacement fields, cubic B-splines and composites of these, in LPS
///   and mm. The inverse is meant of 3D Slicer's InverseDisplacementFieldTransform and
///   InverseBSplineTransform
/// - NIfTI displacement fields. The intent code states the axes of the components: VECTOR is LPS
///   and mm (ITK, ANTs), DISPVECT is RAS in the header's unit, VECTOR named NREG_TRANS is
///   NiftyReg's: displacements or positions in RAS. Any other needs `axes`
/// - Warp fields of FSL (intent 2006): relative or absolute, in scaled voxels of the field's and
///   the image's grid
/// - NRRD files and MetaImages of three components: LPS and mm, as ITK and 3D Slicer write them.
///   With NRRD's key `displacement field type` of `modeling` the inverse is meant
/// - the array `tetwarp_displacement` of a VTKHDF volume, as `tetwarp warp` writes it
/// @throws IoError  on other transforms, files that do not tell their convention, damaged files
TETWARP_IO_EXPORT TransformFile read_transform(const std::string& path,
                                               const TransformReadOptions& options = {});

/// The same without the displacements of fields. Those of text and MATLAB files are in memory.
/// @throws IoError  as above; the readers throw it, too
TETWARP_IO_EXPORT TransformParts open_transform(const std::string& path,
                                                const TransformReadOptions& options = {});

}  // namespace tetwarp
