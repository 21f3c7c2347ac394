/// @file file_checks.hpp
/// Checks of paths before any work is done. All throw IoError.
#pragma once
#include <string>
#include <vector>

#include <tetwarp/io.hpp>

namespace tetwarp::cli {

/// The file can be written: it is no folder and none of `inputs`, and its folder takes new files.
void check_output_file(const std::string& output, const std::vector<std::string>& inputs);

/// The folder exists and takes new files.
void check_output_folder(const std::string& folder, const std::string& output);

/// The name ends in .vtkhdf, .hdf or .h5.
void check_hdf_name(const std::string& output);

/// The file can be opened and is of this kind; `remedy` ends the message.
void check_kind(const std::string& path, FileKind wanted, const std::string& remedy);

/// "a volume", "a mesh" and so on.
const char* name_of(FileKind kind);

/// One spelling per file, whether it exists or not: absolute, links and dots resolved.
std::string canonical_path(const std::string& path);

}  // namespace tetwarp::cli
