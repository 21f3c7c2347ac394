#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string_view>
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

/// A header of NIfTI-2, NIfTI or Analyze that read_nifti() does not take, plain or gzip.
FileKind header_kind(const std::string& path) {
  NiftiStream stream(path, "rb", true);
  std::array<char, 348> header{};
  if (!stream || !stream.read(header.data(), header.size())) return FileKind::unknown;
  const auto begins_with = [&](std::int32_t size) {  // in either byte order
    std::array<char, 4> bytes{};
    std::memcpy(bytes.data(), &size, bytes.size());
    return std::equal(bytes.begin(), bytes.end(), header.begin()) ||
           std::equal(bytes.rbegin(), bytes.rend(), header.begin());
  };
  if (begins_with(540)) {
    const std::string_view magic(header.data() + 4, 3);
    return magic == "n+2" || magic == "ni2" ? FileKind::nifti2 : FileKind::unknown;
  }
  const bool is_half = std::string_view(header.data() + 344, 3) == "ni1" ||
                       path.ends_with(".hdr") || path.ends_with(".hdr.gz");
  return begins_with(348) && is_half ? FileKind::image_pair : FileKind::unknown;
}

/// The header that belongs to a file of samples, NAME.hdr to NAME.img; else the file itself.
std::string header_path(const std::string& path) {
  for (const std::string end : {".img", ".img.gz"}) {
    if (!path.ends_with(end)) continue;
    const std::string header = path.substr(0, path.size() - end.size()) + ".hdr";
    for (const std::string& name : {header, header + ".gz"}) {
      if (std::filesystem::is_regular_file(name)) return name;
    }
  }
  return path;
}
}  // namespace

FileKind kind_of(const std::string& path) {
  const h5::Silence silence;
  if (has_nifti_header(path)) return FileKind::nifti;
  return H5Fis_hdf5(path.c_str()) > 0 ? hdf5_kind(path) : header_kind(header_path(path));
}

void check_sound(const std::string& path, FileKind kind) {
  if (kind != FileKind::hdf5) return;
  const h5::Silence silence;
  h5::open_file(path);
}

}  // namespace tetwarp
