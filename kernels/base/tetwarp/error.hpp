/// @file error.hpp
/// Error classes of the library. Bad arguments are std::invalid_argument; nothing prints or exits.
#pragma once
#include <stdexcept>
#include <string>

namespace tetwarp {

/// A file could not be read or written. `what()` is one line: file, dataset, problem, how to fix
/// it.
class IoError : public std::runtime_error {
 public:
  /// @param file     path as the caller gave it
  /// @param dataset  path inside the file; empty if the error concerns the whole file
  /// @param problem  what is wrong and how to fix it
  IoError(std::string file, std::string dataset, const std::string& problem);

  const std::string& file() const { return file_; }
  const std::string& dataset() const { return dataset_; }

 private:
  std::string file_;
  std::string dataset_;
};

/// A CUDA call failed, or no device is available. `what()` names the call and CUDA's error.
class CudaError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The progress callback requested cancellation. Outputs of the interrupted step are undefined.
class Cancelled : public std::runtime_error {
 public:
  Cancelled() : std::runtime_error("cancelled") {}
};

}  // namespace tetwarp
