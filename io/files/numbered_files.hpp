/// @file numbered_files.hpp
/// Series of numbered files, named by one pattern, and names of meshes in several files.
#pragma once
#include <string>
#include <vector>

#include <tetwarp/io_export.hpp>

namespace tetwarp {

/// Whether a path is a pattern of files: its last part has a '*', and no file has that name.
TETWARP_IO_EXPORT bool is_pattern(const std::string& path);

/// The files that a pattern matches, '*' standing for any letters; in order of the numbers in their
/// names, else of the alphabet. @throws IoError when there are none
TETWARP_IO_EXPORT std::vector<std::string> numbered_files(const std::string& pattern);

/// True for the names of Exodus files: .e, .exo or .ex2, also in capital letters.
bool is_exodus_name(const std::string& path);

/// A file and those that it lists, or the samples that lie beside it, as far as they are there; of
/// a pattern its files, of a folder the files in it.
TETWARP_IO_EXPORT std::vector<std::string> files_of(const std::string& path);

/// Bytes of files_of().
double bytes_of_files(const std::string& path);

}  // namespace tetwarp
