/// @file error.hpp
/// Error classes of the library. Bad arguments throw std::invalid_argument; the library never
/// prints and never exits.
#pragma once
#include <stdexcept>
#include <string>

#include <tetwarp/export.hpp>

namespace tetwarp {

/// A file could not be read or written. `what()` is one line that names the file, the dataset and
/// what to change.
class TETWARP_EXPORT IoError : public std::runtime_error {
 public:
  /// @param file     path as the caller gave it
  /// @param dataset  path inside the file; empty: the error concerns the file as a whole
  /// @param problem  what is wrong and how to correct it
  IoError(std::string file, std::string dataset, const std::string& problem);

  const std::string& file() const { return file_; }
  const std::string& dataset() const { return dataset_; }

 private:
  std::string file_;
  std::string dataset_;
};

/// A CUDA call failed, or no usable device was found. `what()` names the call and the reason that
/// the CUDA runtime gives.
class TETWARP_EXPORT CudaError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The progress callback returned false. The outputs of the interrupted step are undefined.
class TETWARP_EXPORT Cancelled : public std::runtime_error {
 public:
  Cancelled() : std::runtime_error("cancelled") {}
};

}  // namespace tetwarp
