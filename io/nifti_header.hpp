/// @file nifti_header.hpp
/// The NIfTI-1 header: checked before anything is allocated, and turned into a grid and back.
#pragma once
#include <nifti1_io.h>

#include <cstdint>
#include <memory>
#include <string>

#include <tetwarp/nifti.hpp>

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

  /// @returns false when the rest of the buffers could not be written
  bool close() { return file_ == nullptr || znzclose(file_) == 0; }

 private:
  znzFile file_;
};

/// The header of a NIfTI file.
struct NiftiHeader {
  Grid grid;
  PixelType type = PixelType::float32;  ///< as stored
  int components = 1;
  bool is_swapped = false;  ///< samples are in the byte order that is not this machine's
  double slope = 1;         ///< value = slope * sample + intercept
  double intercept = 0;
  std::int64_t data_offset = 352;  ///< first sample [byte], uncompressed
  NiftiFacts facts{};

  bool is_scaled() const { return slope != 1 || intercept != 0; }
};

/// True when the file begins with the header of a single-file NIfTI-1. Throws IoError when it
/// cannot be opened.
bool has_nifti_header(const std::string& path);

/// Reads and checks the header. Throws IoError.
NiftiHeader read_nifti_header(const std::string& path);

/// The header of a file for `volume`. Throws IoError about `path` when NIfTI-1 cannot hold it.
nifti_1_header make_nifti_header(const std::string& path,
                                 const Volume& volume,
                                 const NiftiFacts& facts);

}  // namespace tetwarp
