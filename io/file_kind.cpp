#include <tetwarp/io.hpp>

#include "io/h5.hpp"
#include "io/nifti_header.hpp"

namespace tetwarp {
namespace {
FileKind hdf5_kind(const std::string& path) {
  try {
    const h5::Object file = h5::open_file(path);
    if (h5::is_group(file, "fclib_local") || h5::is_group(file, "fclib_global")) {
      return FileKind::contact_problem;
    }
    if (!h5::is_group(file, "VTKHDF")) return FileKind::hdf5;
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
}  // namespace

FileKind kind_of(const std::string& path) {
  const h5::Silence silence;
  if (has_nifti_header(path)) return FileKind::nifti;
  return H5Fis_hdf5(path.c_str()) > 0 ? hdf5_kind(path) : FileKind::unknown;
}

}  // namespace tetwarp
