/// @file file_checks.cpp
/// The checks of paths and their messages.
#include "host/cli/common/file_checks.hpp"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>
#include <tetwarp/mesh_import.hpp>

#include "io/files/extension.hpp"
#include "io/files/finished_file.hpp"

namespace tetwarp::cli {
namespace fs = std::filesystem;

void check_output_folder(const std::string& folder, const std::string& output) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    throw IoError(output, "", "'" + folder + "' is not a folder; name another one");
  }
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    throw IoError(output, "", "no permission to write in folder '" + folder + "'");
  }
}

std::string existing_folder(const std::string& folder) {
  if (folder.empty()) return ".";
  std::error_code error;
  fs::path above = fs::exists(folder, error) ? fs::path(folder) : fs::absolute(folder, error);
  while (!fs::exists(above, error) && above.has_relative_path()) above = above.parent_path();
  return above.string();
}

void check_new_folder(const std::string& folder, const std::string& output) {
  check_output_folder(existing_folder(folder), output);
}

void check_output_file(const std::string& output, const std::vector<std::string>& inputs) {
  std::error_code error;
  if (output.empty()) throw IoError("output", "", "its name is empty");
  if (fs::is_directory(output, error)) {
    throw IoError(output, "", "is a folder; name the file to write");
  }
  if (fs::exists(output, error) && !fs::is_regular_file(output, error)) {
    throw IoError(output, "", "exists and is not a regular file; choose another name");
  }
  check_no_input(output, inputs);
  check_new_folder(fs::path(link_target(output)).parent_path().string(), output);
}

void check_output_files(const std::vector<std::string>& outputs,
                        const std::vector<std::string>& inputs) {
  std::set<std::string> seen;
  for (const std::string& output : outputs) {
    check_output_file(output, inputs);
    if (!seen.insert(canonical_path(output)).second) {
      throw IoError(output, "", "would be written twice; choose another name");
    }
  }
}

void check_hdf_name(const std::string& output) {
  if (has_one_of(output, vtkhdf_endings)) return;
  throw IoError(output, "", "the name of a VTKHDF file ends in " + listed_endings(vtkhdf_endings));
}

void check_volume_name(const std::string& output) {
  if (has_one_of(output, volume_endings)) return;
  throw IoError(output, "", "the name of a volume ends in " + listed_endings(volume_endings));
}

namespace {
/// A format that is not read, by the end of a file's name.
struct ForeignFormat {
  const char* extension;
  const char* noun;
  const char* remedy;
};

constexpr const char* to_nifti = "convert it to NIfTI, for example by SimpleITK or 3D Slicer";
constexpr const char* to_vtu =
    "convert it to .vtu, .vtk or .msh, for example by ParaView or meshio";
constexpr const char* to_mesh =
    "make a mesh of tetrahedra of it: tetwarp mesh --from-surface, or Gmsh";
constexpr const char* to_vti = "save it as .vti, for example by ParaView";
constexpr ForeignFormat foreign_formats[] = {
    {".dcm", "DICOM file without 'DICM' at byte 128", to_nifti},
    {".pvti", "VTK image in several files", to_vti},
    {".vtr", "VTK grid of uneven spacing", to_vti},
    {".vts", "curvilinear VTK grid", to_vti},
    {".tif", "TIFF image", to_nifti},
    {".tiff", "TIFF image", to_nifti},
    {".pvtu", "mesh in several files", to_vtu},
    {".inp", "Abaqus mesh", to_vtu},
    {".med", "MED mesh", to_vtu},
    {".xdmf", "XDMF mesh", to_vtu},
    {".xmf", "XDMF mesh", to_vtu},
    {".mesh", "Medit mesh", to_vtu},
    {".stl", "surface", to_mesh},
    {".ply", "surface", to_mesh},
    {".obj", "surface", to_mesh},
    {".vtp", "surface", to_mesh}};

/// Throws IoError for a file that is known not to be readable: of another format, or empty.
void refuse_foreign(const std::string& path, const std::string& expected) {
  std::error_code error;
  if (fs::is_regular_file(path, error) && fs::file_size(path, error) == 0) {
    throw IoError(path, "", "is empty, expected a " + expected + "; copy it again");
  }
  for (const ForeignFormat& format : foreign_formats) {
    if (!has_extension(path, format.extension)) continue;
    throw IoError(path, "",
                  std::string("is a ") + format.noun + ", which is not read; " + format.remedy);
  }
}

/// What a file is, in words for a message.
std::string noun_of(const std::string& path, FileKind kind) {
  std::error_code error;
  if (fs::is_directory(path, error)) return "folder";
  if (kind == FileKind::unknown && has_mesh_extension(path)) return "mesh";
  if (kind == FileKind::unknown && (has_nifti_name(path) || has_extension(path, ".hdr"))) {
    return "file without a NIfTI header (damaged, truncated or of another format)";
  }
  if (kind == FileKind::unknown && has_vtk_image_name(path)) {
    return "file without a VTK image (damaged, truncated or of another format)";
  }
  if (kind == FileKind::unknown && (has_extension(path, ".mgz") || has_extension(path, ".mgh"))) {
    return "file without a header of FreeSurfer (damaged, truncated or of another format)";
  }
  return name_of(kind);
}

[[noreturn]] void refuse_kind(const std::string& path,
                              FileKind kind,
                              const std::string& expected,
                              const std::string& remedy) {
  if (kind == FileKind::unknown) refuse_foreign(path, expected);
  const bool is_analyze = kind == FileKind::analyze;
  throw IoError(
      path, "",
      "is a " + noun_of(path, kind) + ", expected a " + expected + "; " +
          (is_analyze ? "convert it to NIfTI: Analyze images have no orientation" : remedy));
}

FileKind sound_kind_of(const std::string& path) {
  const FileKind kind = kind_of(path);
  check_sound(path, kind);
  return kind;
}
}  // namespace

void check_kind(const std::string& path, FileKind expected, const std::string& remedy) {
  const FileKind kind = sound_kind_of(path);
  if (kind != expected) refuse_kind(path, kind, name_of(expected), remedy);
}

void check_volume(const std::string& path, const std::string& remedy) {
  const FileKind kind = sound_kind_of(path);
  if (kind != FileKind::volume && kind != FileKind::nifti && kind != FileKind::image) {
    refuse_kind(path, kind, "volume", remedy);
  }
}

void check_series(const std::string& series,
                  const std::vector<std::string>& volumes,
                  const std::string& option) {
  const auto is_folder = [](const std::string& path) {
    std::error_code error;
    return fs::is_directory(path, error);
  };
  if (series.empty() || std::ranges::any_of(volumes, is_folder)) return;
  throw IoError(volumes.front(), "",
                "is no folder; " + option + " is for folders of DICOM images, leave it out");
}

void check_mesh(const std::string& path, const std::string& remedy) {
  const FileKind kind = sound_kind_of(path);
  const bool is_imported = kind == FileKind::unknown && has_mesh_extension(path);
  if (kind != FileKind::mesh && !is_imported) refuse_kind(path, kind, "mesh", remedy);
}

}  // namespace tetwarp::cli
