/// @file file_kind.cpp
/// The kind of a file by its content.
#include <string>
#include <tetwarp/io.hpp>

#include "io/child/image_kind.hpp"
#include "io/files/extension.hpp"
#include "io/files/numbered_files.hpp"
#include "io/h5/h5.hpp"
#include "io/h5/h5_attribute.hpp"
#include "io/h5/h5_read.hpp"
#include "io/image/image_volume.hpp"
#include "io/nifti/nifti_header.hpp"

namespace tetwarp {
namespace {
FileKind hdf5_kind(const std::string& path) {
  try {
    const h5::Object file = h5::open_file(path);
    if (h5::is_group(file, "fclib_local") || h5::is_group(file, "fclib_global")) {
      return FileKind::contact_problem;
    }
    if (!h5::is_group(file, "VTKHDF")) {
      // Exodus in netCDF-4, among others: meshes, which their names tell.
      return has_mesh_extension(path) ? FileKind::unknown : FileKind::hdf5;
    }
    const h5::Object root = h5::open_group(file, "VTKHDF");
    if (!h5::has_attribute(root, "Type")) return FileKind::other_vtkhdf;
    const std::string type = h5::read_text_attribute(root, "Type");
    if (type == "ImageData") return FileKind::volume;
    if (type == "UnstructuredGrid") return FileKind::mesh;
    return FileKind::other_vtkhdf;
  } catch (const IoError&) {
    return FileKind::hdf5;  // it has the signature; a reader reports the damage
  }
}

/// Analyze has no magic number: its header is recognized by its size and its name.
bool is_analyze(const std::string& header_path, const NiftiStart& start) {
  return start.is_analyze &&
         (has_extension(header_path, ".hdr") || has_extension(header_path, ".hdr.gz"));
}
}  // namespace

FileKind kind_of(const std::string& path) {
  if (is_pattern(path)) return FileKind::unknown;  // of meshes, which their names tell
  if (is_foreign_image(path)) return FileKind::image;
  const h5::Silence silence;
  const std::string header_path = nifti_header_path(path);
  const NiftiStart start = read_nifti_start(header_path);
  if (start.fields) return FileKind::nifti;
  if (H5Fis_hdf5(path.c_str()) > 0) return hdf5_kind(path);
  if (is_image(path)) return FileKind::image;
  return is_analyze(header_path, start) ? FileKind::analyze : FileKind::unknown;
}

void check_sound(const std::string& path, FileKind kind) {
  if (kind != FileKind::hdf5) return;
  const h5::Silence silence;
  h5::open_file(path);
}

}  // namespace tetwarp
