/// @file output_writer.hpp
/// The files of an output: one of VTKHDF for all arrays, or one NIfTI image for each array.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>

namespace tetwarp::cli {

/// An array as a NIfTI image holds it: with its facts, or the defaults if it has none.
/// @param axes  of vectors and tensors; nothing: those of the file that the array comes from.
///              Displacement fields of the warp are written as ITK and ANTs read them, unless RAS
///              is asked for
ArrayHeader nifti_array(ArrayHeader array, const std::optional<Axes>& axes = {});

/// What is left out of a displacement field of two components.
inline constexpr const char* itk_slice_note =
    "the displacement field of a single slice has the two components in the slice, as ITK's 2D "
    "transforms take it; the third one is left out";

/// NAME and EXTENSION of a file; .nii.gz is one extension.
struct SplitName {
  std::string stem;  ///< with its folder
  std::string extension;
};
SplitName split_name(const std::string& path);

/// True for names of formats of one array per file: NIfTI, NRRD, MetaImage.
bool holds_one_array(const std::string& path);

/// The files that hold the arrays of an output. Of several NIfTI images the first one has the name
/// of the output, NAME.nii.gz, and the others NAME_ARRAY.nii.gz without `tetwarp_`.
std::vector<std::string> files_of_output(const std::string& output,
                                         const std::vector<ArrayHeader>& arrays);

/// Throws std::invalid_argument where a level of deflate is given and none of the outputs is
/// packed.
void check_compress(const std::vector<std::string>& outputs, int level);

/// Throws IoError about what a file of an output cannot hold, before any is written. Arguments as
/// of OutputWriter.
void check_output_arrays(const std::string& output,
                         const Grid& grid,
                         const std::vector<ArrayHeader>& arrays,
                         const VolumeWriteOptions& options,
                         bool is_temporal);

/// Writes these files region by region; calls and errors as of BlockVolumeWriter.
class OutputWriter {
 public:
  /// @param changing  number of arrays, the first ones, that differ from step to step of a series;
  ///                  NIfTI images of the others hold the first step alone
  OutputWriter(const std::string& output,
               const Grid& grid,
               const std::vector<ArrayHeader>& arrays,
               const VolumeWriteOptions& options,
               bool is_temporal,
               std::size_t changing,
               ChunkShape chunks);

  void begin_step(double time);
  void repeat_step(double time);
  void write(std::size_t array, const Region& region, const void* samples);
  /// @returns the sums over all files
  WrittenFile finish();

 private:
  std::vector<BlockVolumeWriter> files_;
  std::size_t changing_;  ///< files that have all steps of a series; the others have the first
  std::int64_t steps_ = 0;
};

}  // namespace tetwarp::cli
