/// @file nifti_samples.hpp
/// Samples of a NIfTI file, read region by region. They are read here and not by the library, which
/// replaces NaN by zero.
#pragma once
#include <cstddef>
#include <memory>
#include <string>

#include "io/files/scratch_file.hpp"
#include "io/nifti/nifti_components.hpp"
#include "io/nifti/nifti_header.hpp"

namespace tetwarp {

/// One step of a NIfTI file. A plain file is read where the region lies. A gzip file can only be
/// read from its beginning: a region that is the whole grid is, and before any other read() unpacks
/// the step, once, to a temporary file.
class NiftiSamples {
 public:
  /// @param axes     axes of the components in the file
  /// @param scratch  a file in whose folder a step is unpacked; empty: the system's temporary one
  /// @throws IoError as read_nifti(), and when there is no such step
  NiftiSamples(
      std::string path, NiftiHeader header, std::int64_t step, Axes axes, std::string scratch);
  ~NiftiSamples();

  const NiftiHeader& header() const { return header_; }

  /// Memory that reading takes beside the samples [byte].
  double buffer_bytes() const;

  /// Space on the disk that an unpacked step takes [byte]; 0: it is not unpacked.
  double unpacked_bytes() const;

  /// Reads a region of the step. @param out  [k][j][i][component], of header().value_type()
  void read(const Region& region, void* out);

  /// The same without a temporary file. Regions of a gzip file with one component should be whole
  /// slices and follow each other; before any other region it is unpacked from its beginning.
  void read_in_order(const Region& region, void* out) const;

 private:
  class Source;

  /// Parts of a file that hold a number, or a color, of every voxel: one per component.
  std::int64_t plane_count() const;
  std::size_t plane_voxel_bytes() const;
  std::int64_t plane_bytes() const;
  std::int64_t plane_offset(std::size_t component) const;
  std::int64_t end_offset() const;
  void unpack();
  void read_component(Source& source, const Region& region, std::size_t c, std::byte* out) const;
  void convert(std::byte* part, std::size_t count, std::size_t c, std::byte* out) const;
  [[noreturn]] void fail() const;

  std::string path_;
  NiftiHeader header_;
  std::int64_t step_;
  std::string scratch_;
  ComponentMap map_;
  std::unique_ptr<ScratchFile> unpacked_;  ///< components one after the other, from byte 0
};

}  // namespace tetwarp
