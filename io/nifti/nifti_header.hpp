/// @file nifti_header.hpp
/// The header of a NIfTI file: checked before anything is allocated, and turned into a grid.
#pragma once
#include <znzlib.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/nifti.hpp>

#include "io/nifti/nifti_fields.hpp"

namespace tetwarp {

/// An open NIfTI file, plain or gzip; closes itself.
class NiftiStream {
 public:
  /// Opens for reading ("rb") or writing ("wb"); null when that fails.
  NiftiStream(const std::string& path, const char* mode, bool is_compressed)
      : file_(znzopen(path.c_str(), mode, is_compressed ? 1 : 0)) {}
  NiftiStream(const NiftiStream&) = delete;
  NiftiStream& operator=(const NiftiStream&) = delete;
  ~NiftiStream() { close(); }

  explicit operator bool() const { return file_ != nullptr; }

  /// False when fewer bytes could be read, written or skipped.
  bool read(void* out, std::size_t bytes) { return znzread(out, 1, bytes, file_) == bytes; }
  bool write(const void* in, std::size_t bytes) { return znzwrite(in, 1, bytes, file_) == bytes; }
  bool seek(std::int64_t offset) { return znzseek(file_, offset, SEEK_SET) >= 0; }
  std::int64_t position() const { return znztell(file_); }

  /// As many of `bytes` as there are, at most.
  std::size_t read_some(void* out, std::size_t bytes) {
    const std::size_t count = znzread(out, 1, bytes, file_);
    return count <= bytes ? count : 0;  // an error is a number below zero
  }

  /// Reads the last bytes that are wanted and what is behind them, where length and checksum of a
  /// gzip file are compared, and closes the file.
  /// @param out  has room for one byte more: zlib goes on to a missing end only if it has room
  /// @returns false as read(), and when the rest is damaged or truncated
  bool read_last(void* out, std::size_t bytes) {
    const std::size_t got = znzread(out, 1, bytes + 1, file_);
    std::array<char, 4096> behind;
    std::size_t count = behind.size();
    while (count == behind.size()) count = znzread(behind.data(), 1, behind.size(), file_);
    return close() && (got == bytes || got == bytes + 1) && count < behind.size();
  }

  /// @returns false when the rest of the buffers could not be written, or when the file that was
  ///          read ends within what gzip has packed
  bool close() { return file_ == nullptr || znzclose(file_) == 0; }

 private:
  znzFile file_;
};

/// The header of a NIfTI file.
struct NiftiHeader {
  Grid grid;
  PixelType type = PixelType::float32;  ///< as stored
  int components = 1;
  bool is_interleaved = false;  ///< components of a voxel follow each other: colors
  std::int64_t steps = 1;       ///< along the axis of time
  std::vector<double> times;    ///< one per step [s, or the unit of the axis]; empty: one step
  bool is_swapped = false;      ///< samples are in the byte order that is not this machine's
  double slope = 1;             ///< value = slope * sample + intercept
  double intercept = 0;
  std::string samples;                ///< the file that holds them
  bool is_gzip = false;               ///< that file
  std::int64_t data_offset = 352;     ///< first sample [byte], uncompressed
  std::string fingerprint;            ///< of the warp that wrote the file; empty: none
  std::vector<std::string> left_out;  ///< of what the header says is in no other member, by name
  NiftiFacts facts{};

  bool is_scaled() const { return slope != 1 || intercept != 0; }
  /// Type of the values: scaled samples are float32, or float64 if they are stored so.
  PixelType value_type() const {
    return is_scaled() && type != PixelType::float64 ? PixelType::float32 : type;
  }
};

/// What the first bytes of a file are, plain or gzip. Throws IoError when it cannot be opened.
NiftiStart read_nifti_start(const std::string& path);

/// The file that holds the header: of a pair NAME.hdr for NAME.img, else the file itself.
std::string nifti_header_path(const std::string& path);

/// Reads and checks the header; of a pair either file may be named. Throws IoError.
NiftiHeader read_nifti_header(const std::string& path);

/// Code of a pixel type in NIfTI.
int nifti_datatype_of(PixelType type);

/// Seconds of one unit of the time axis; 1 where `xyzt_units` names none.
double nifti_time_unit(std::int64_t xyzt_units);

/// Millimeters of one unit of length, as ITK takes it; 1 where `xyzt_units` names none.
double nifti_length_unit(std::int64_t xyzt_units);

}  // namespace tetwarp
