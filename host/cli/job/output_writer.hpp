/// @file output_writer.hpp
/// The files of an output: one of VTKHDF for all arrays, or one NIfTI image for each array.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>

namespace tetwarp::cli {

/// An array as a NIfTI image holds it: with its facts, or the defaults if it has none.
/// @param axes  of vectors and tensors; nothing: LPS for displacement fields of the warp, which ITK
///              and ANTs read, else those of the file that the array comes from
ArrayHeader nifti_array(ArrayHeader array, const std::optional<Axes>& axes = {});

/// NAME and EXTENSION of a file; .nii.gz is one extension.
struct SplitName {
  std::string stem;  ///< with its folder
  std::string extension;
};
SplitName split_name(const std::string& path);

/// The files that hold the arrays of an output. Of several NIfTI images the first one has the name
/// of the output, NAME.nii.gz, and the others NAME_ARRAY.nii.gz without `tetwarp_`.
std::vector<std::string> files_of_output(const std::string& output,
                                         const std::vector<ArrayHeader>& arrays);

/// Writes these files region by region; calls and errors as of BlockVolumeWriter.
class OutputWriter {
 public:
  OutputWriter(const std::string& output,
               const Grid& grid,
               const std::vector<ArrayHeader>& arrays,
               const VolumeWriteOptions& options,
               bool is_temporal,
               ChunkShape chunks);

  void begin_step(double time);
  void repeat_step(double time);
  void write(std::size_t array, const Region& region, const void* samples);
  /// @returns the sums over all files
  WrittenFile finish();

 private:
  std::vector<BlockVolumeWriter> files_;
};

}  // namespace tetwarp::cli
