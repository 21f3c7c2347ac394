/// @file missing_library.hpp
/// The error of a format whose library was missing when the project was built.
#pragma once
#include <string>
#include <utility>

#include <tetwarp/error.hpp>
#include <tetwarp/io_export.hpp>

namespace tetwarp {

/// A file could not be read, because tetwarp-read was built without the library for it: what
/// import_mesh(), read_volume() and other calls that read by VTK, Gmsh or GDCM throw then.
class TETWARP_IO_EXPORT MissingLibrary : public IoError {
 public:
  /// @param file     path as the caller gave it
  /// @param library  "VTK", "Gmsh" or "GDCM"
  /// @param problem  what is wrong and how to correct it
  MissingLibrary(const std::string& file, std::string library, const std::string& problem)
      : IoError(file, "", problem), library_(std::move(library)) {}

  const std::string& library() const { return library_; }

 private:
  std::string library_;
};

}  // namespace tetwarp
