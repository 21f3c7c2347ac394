/// @file io_files.hpp
/// Scratch folders, small volumes and meshes, and files made or edited with HDF5 alone, as other
/// programs would.
#pragma once
#include <hdf5.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>

#include "tests/support/message_of.hpp"

namespace tetwarp::test {

inline std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// A temporary folder, removed at the end.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "tetwarp-io-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

  /// Number of entries, hidden ones too.
  std::ptrdiff_t entry_count() const {
    return std::distance(std::filesystem::directory_iterator(path_), {});
  }

 private:
  std::filesystem::path path_;
};

/// An oblique grid with another spacing on each axis.
inline Grid oblique_grid() {
  Grid grid;
  grid.dims = {7, 5, 4};
  grid.origin = {-3.5, 10, 1e4};
  grid.spacing = {0.5, 1.25, 3};
  grid.direction = {0, -1, 0, 0.6, 0, -0.8, 0.8, 0, 0.6};
  return grid;
}

/// Different bytes in every sample that are no NaN in any type.
inline Volume counting_volume(PixelType type, int components = 1, std::string name = "values") {
  Volume volume = make_volume(oblique_grid(), type, components, std::move(name));
  for (std::size_t b = 0; b < volume.data.size(); ++b) {
    volume.data[b] = static_cast<std::byte>((b * 37 + b / 251) % 120);
  }
  return volume;
}

/// Two tetrahedra that share a face.
inline Mesh two_tets() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}, {{0, 1, 2, 3}, {1, 2, 3, 4}}};
}

/// One displacement of all nodes of two_tets() per offset along x.
inline std::vector<std::vector<Point3>> slides(const std::vector<double>& offsets) {
  std::vector<std::vector<Point3>> steps;
  steps.reserve(offsets.size());
  for (const double x : offsets) steps.emplace_back(5, Point3{x, 0, 0});
  return steps;
}

inline hid_t native_type(std::uint8_t) {
  return H5T_NATIVE_UINT8;
}
inline hid_t native_type(std::int16_t) {
  return H5T_NATIVE_INT16;
}
inline hid_t native_type(std::int32_t) {
  return H5T_NATIVE_INT32;
}
inline hid_t native_type(std::int64_t) {
  return H5T_NATIVE_INT64;
}
inline hid_t native_type(float) {
  return H5T_NATIVE_FLOAT;
}
inline hid_t native_type(double) {
  return H5T_NATIVE_DOUBLE;
}

/// An HDF5 file open for changes. What is written replaces what has the same name.
class Hdf5Editor {
 public:
  enum class Mode { create, edit };

  explicit Hdf5Editor(const std::string& path, Mode mode = Mode::edit)
      : file_(mode == Mode::create
                  ? H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)
                  : H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT)) {
    if (file_ < 0) throw std::runtime_error("cannot edit " + path);
  }
  ~Hdf5Editor() { H5Fclose(file_); }
  Hdf5Editor(const Hdf5Editor&) = delete;
  Hdf5Editor& operator=(const Hdf5Editor&) = delete;

  Hdf5Editor& group(const std::string& name) {
    H5Gclose(H5Gcreate2(file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    return *this;
  }

  Hdf5Editor& remove(const std::string& name) {
    H5Ldelete(file_, name.c_str(), H5P_DEFAULT);
    return *this;
  }

  Hdf5Editor& external_link(const std::string& name,
                            const std::string& file,
                            const std::string& object) {
    H5Lcreate_external(file.c_str(), object.c_str(), file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
    return *this;
  }
  Hdf5Editor& remove_attribute(const std::string& object, const std::string& name) {
    H5Adelete_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT);
    return *this;
  }

  /// Without values the dataset has that shape and nothing in it, chunked. Values of an enumeration
  /// are in the file's byte order.
  template <class T>
  Hdf5Editor& dataset(const std::string& name,
                      const std::vector<hsize_t>& dims,
                      const std::vector<T>& values,
                      hid_t file_type = H5I_INVALID_HID) {
    if (H5Lexists(file_, name.c_str(), H5P_DEFAULT) > 0) remove(name);
    const int rank = static_cast<int>(dims.size());
    const hid_t space = H5Screate_simple(rank, dims.data(), nullptr);
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    const std::vector<hsize_t> chunk(dims.size(), 1);
    if (values.empty()) H5Pset_chunk(properties, rank, chunk.data());
    if (file_type < 0) file_type = native_type(T{});
    const hid_t data =
        H5Dcreate2(file_, name.c_str(), file_type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    if (!values.empty()) {
      const hid_t memory_type = H5Tget_class(file_type) == H5T_ENUM ? file_type : native_type(T{});
      H5Dwrite(data, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    }
    H5Dclose(data);
    H5Pclose(properties);
    H5Sclose(space);
    return *this;
  }

  template <class T>
  Hdf5Editor& attribute(const std::string& object,
                        const std::string& name,
                        const std::vector<T>& values) {
    const hsize_t count = values.size();
    const hid_t space = H5Screate_simple(1, &count, nullptr);
    write_attribute(object, name, native_type(T{}), space, values.data());
    return *this;
  }

  /// A string of variable length, as h5py writes it by default.
  Hdf5Editor& text(const std::string& object, const std::string& name, const std::string& value) {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, H5T_VARIABLE);
    const char* pointer = value.c_str();
    write_attribute(object, name, type, H5Screate(H5S_SCALAR), &pointer);
    H5Tclose(type);
    return *this;
  }

 private:
  void write_attribute(const std::string& object,
                       const std::string& name,
                       hid_t type,
                       hid_t space,
                       const void* values) {
    const hid_t owner = H5Oopen(file_, object.c_str(), H5P_DEFAULT);
    if (H5Aexists(owner, name.c_str()) > 0) H5Adelete(owner, name.c_str());
    const hid_t attribute = H5Acreate2(owner, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, type, values);
    H5Aclose(attribute);
    H5Sclose(space);
    H5Oclose(owner);
  }

  hid_t file_;
};

/// The line of the IoError that `op` throws; empty when it throws none.
template <class Op>
std::string io_error(const Op& op) {
  return message_of<IoError>(op);
}

}  // namespace tetwarp::test
