/// @file file_checks.hpp
/// Checks of paths before any work is done. All throw IoError.
#pragma once
#include <string>
#include <vector>

#include <tetwarp/io.hpp>

#include "io/files/input_check.hpp"

namespace tetwarp::cli {

/// Checks that a file can be written: not a folder, none of `inputs`, and its folder is writable or
/// can be made, as FinishedFile does.
void check_output_file(const std::string& output, const std::vector<std::string>& inputs);

/// Checks the files that a job writes as check_output_file() does, and that no two of them are the
/// same file.
void check_output_files(const std::vector<std::string>& outputs,
                        const std::vector<std::string>& inputs);

/// A folder, or of one that does not exist the nearest above it that does. @param folder  empty:
/// "."
std::string existing_folder(const std::string& folder);

/// Checks that a folder exists and is writable. @param output  named in the message
void check_output_folder(const std::string& folder, const std::string& output);

/// Checks that a folder is writable or can be made: it, or the nearest one above it that exists, is
/// writable. @param output  named in the message
void check_new_folder(const std::string& folder, const std::string& output);

/// Checks that a name ends in .vtkhdf, .hdf or .h5.
void check_hdf_name(const std::string& output);

/// Checks that a name is that of a volume: one of volume_endings.
void check_volume_name(const std::string& output);

/// Checks that a file can be opened and is of this kind. @param remedy  the message ends with it
void check_kind(const std::string& path, FileKind expected, const std::string& remedy);

/// Checks that a file can be opened and is a volume, VTKHDF or NIfTI.
void check_volume(const std::string& path, const std::string& remedy);

/// Checks that a series is named only if one of the volumes is a folder, of DICOM images.
/// @param option  that names it
void check_series(const std::string& series,
                  const std::vector<std::string>& volumes,
                  const std::string& option = "--series");

/// Checks that a file can be opened and is a mesh: VTKHDF, or by its name Gmsh's or VTK's.
void check_mesh(const std::string& path, const std::string& remedy);

}  // namespace tetwarp::cli
