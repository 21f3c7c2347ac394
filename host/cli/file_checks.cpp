#include "host/cli/file_checks.hpp"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <tetwarp/mesh_import.hpp>

#include "io/finished_file.hpp"

namespace tetwarp::cli {
namespace fs = std::filesystem;

void check_output_folder(const std::string& folder, const std::string& output) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw IoError(output, "", "folder '" + folder + "' does not exist; create it first");
  }
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    throw IoError(output, "", "no permission to write in folder '" + folder + "'");
  }
}

void check_new_folder(const std::string& folder, const std::string& output) {
  std::error_code error;
  fs::path above = fs::absolute(folder, error);
  while (!fs::exists(above, error) && above.has_relative_path()) above = above.parent_path();
  check_output_folder(above.string(), output);
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
  const std::string canonical = canonical_path(output);
  for (const std::string& input : inputs) {
    if (canonical == canonical_path(input) || fs::equivalent(output, input, error)) {
      throw IoError(output, "", "is also an input; name another output");
    }
  }
  const std::string folder = fs::path(link_target(output)).parent_path().string();
  check_output_folder(folder.empty() ? "." : folder, output);
}

void check_hdf_name(const std::string& output) {
  const std::string extension = fs::path(output).extension().string();
  const std::vector<std::string> known{".vtkhdf", ".hdf", ".h5"};
  if (std::find(known.begin(), known.end(), extension) == known.end()) {
    throw IoError(output, "", "the name of a VTKHDF file ends in .vtkhdf, .hdf or .h5");
  }
}

namespace {
/// How a file becomes one of the expected kind; empty: not by a conversion.
std::string conversion_of(const std::string& path, FileKind kind, FileKind expected) {
  const bool is_image = expected == FileKind::volume || expected == FileKind::nifti;
  if (is_image && (kind == FileKind::nifti2 || kind == FileKind::image_pair)) {
    return "write it as a single NIfTI-1 file, .nii or .nii.gz, and convert that with tetwarp "
           "import";
  }
  const bool is_imported = (kind == FileKind::nifti && expected == FileKind::volume) ||
                           (expected == FileKind::mesh && has_mesh_extension(path));
  return is_imported ? "convert it first: tetwarp import " + path + " -o NAME.vtkhdf" : "";
}
}  // namespace

void check_kind(const std::string& path, FileKind expected, const std::string& remedy) {
  const FileKind kind = kind_of(path);
  check_sound(path, kind);
  if (kind == expected) return;
  const std::string conversion = conversion_of(path, kind, expected);
  throw IoError(path, "",
                std::string("is a ") + name_of(kind) + ", expected a " + name_of(expected) + "; " +
                    (conversion.empty() ? remedy : conversion));
}

std::string canonical_path(const std::string& path) {
  std::error_code error;
  const fs::path canonical = fs::weakly_canonical(fs::absolute(link_target(path)), error);
  return error ? path : canonical.string();
}

}  // namespace tetwarp::cli
