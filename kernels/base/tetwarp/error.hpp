/// @file error.hpp
/// Error classes of the library. Bad arguments are std::invalid_argument; nothing prints or exits.
#pragma once
#include <stdexcept>
#include <string>

#include <tetwarp/export.hpp>

namespace tetwarp {

/// A file could not be read or written. `what()` is one line naming file, dataset and remedy.
class TETWARP_EXPORT IoError : public std::runtime_error {
 public:
  /// @param file     path as the caller gave it
  /// @param dataset  path inside the file, empty when the file as a whole is meant
  /// @param problem  what is wrong and what would mend it
  IoError(std::string file, std::string dataset, const std::string& problem);

  const std::string& file() const { return file_; }
  const std::string& dataset() const { return dataset_; }

 private:
  std::string file_;
  std::string dataset_;
};

/// A CUDA call failed, or no device answers. `what()` carries the call and the runtime's reason.
class TETWARP_EXPORT CudaError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The progress callback asked to stop. Nothing of the interrupted step is valid.
class TETWARP_EXPORT Cancelled : public std::runtime_error {
 public:
  Cancelled() : std::runtime_error("cancelled") {}
};

}  // namespace tetwarp
