/// @file nifti_fields.hpp
/// The headers of NIfTI-1 and NIfTI-2 as bytes: what is used of them, read and written.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tetwarp {

/// Fields of a header in this machine's byte order, under their names in the format.
struct NiftiFields {
  int version = 1;       ///< 1 or 2
  bool is_pair = false;  ///< header and samples are two files, .hdr and .img
  std::array<std::int64_t, 8> dim{};
  std::array<double, 8> pixdim{};
  std::int64_t datatype = 0;
  std::int64_t bitpix = 0;
  double vox_offset = 0;
  double scl_slope = 0;
  double scl_inter = 0;
  double cal_max = 0;
  double cal_min = 0;
  double slice_duration = 0;
  std::int64_t slice_start = 0;
  std::int64_t slice_end = 0;
  std::int64_t slice_code = 0;
  std::int64_t dim_info = 0;
  double toffset = 0;
  std::int64_t xyzt_units = 0;
  std::int64_t intent_code = 0;
  std::array<double, 3> intent_p{};
  std::string intent_name;
  std::string descrip;
  std::string aux_file;
  std::int64_t qform_code = 0;
  std::int64_t sform_code = 0;
  std::array<double, 3> quatern{};
  std::array<double, 3> qoffset{};
  std::array<std::array<double, 4>, 3> srow{};

  /// Bytes of the header, without the four bytes that announce extensions.
  std::size_t header_bytes() const { return version == 1 ? 348 : 540; }
};

/// What the first bytes of a file are.
struct NiftiStart {
  std::optional<NiftiFields> fields;  ///< nothing: no NIfTI header
  bool is_swapped = false;            ///< the bytes are not in this machine's order
  bool has_extensions = false;        ///< announced behind the header
  bool is_analyze = false;  ///< a header of Analyze 7.5, which has the size of NIfTI-1 alone
};

/// Decodes the first bytes of a file. @param bytes  544, or fewer where the file is shorter
NiftiStart decode_nifti(const std::vector<char>& bytes);

/// The header as bytes, and four more, the first of which is 1 if extensions follow.
std::vector<char> encode_nifti(const NiftiFields& fields, bool has_extensions);

}  // namespace tetwarp
