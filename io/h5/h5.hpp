/// @file h5.hpp
/// HDF5 handles that close themselves, objects whose failures name file and dataset, and types.
#pragma once
#include <hdf5.h>

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <tetwarp/volume.hpp>

namespace tetwarp::h5 {

/// Turns off error messages that HDF5 prints, until the destructor restores the setting.
class Silence {
 public:
  Silence();
  ~Silence();
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  H5E_auto2_t print_ = nullptr;
  void* argument_ = nullptr;
};

/// Owns one HDF5 identifier.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);

  Handle() = default;
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept
      : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Handle() { close(); }

  /// @returns false when HDF5 could not write the rest of its buffers
  bool close() { return id_ < 0 || close_(std::exchange(id_, H5I_INVALID_HID)) >= 0; }

  explicit operator bool() const { return id_ >= 0; }
  hid_t id() const { return id_; }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

/// Throws IoError unless `bytes` of memory are available. @param name  of the dataset
void check_memory(const std::string& file, const std::string& name, double bytes);

/// The innermost error text of HDF5's last failure in this thread, in one line; empty: none.
std::string last_reason();

/// An open file, group or dataset, with its name for messages.
struct Object {
  std::string file;  ///< path as the caller gave it
  std::string name;  ///< path inside the file, "/VTKHDF/Points"; empty: the file itself
  Handle handle;

  hid_t id() const { return handle.id(); }

  /// Throws IoError about this object.
  [[noreturn]] void fail(const std::string& problem) const;
  /// The same with HDF5's reason in brackets.
  [[noreturn]] void fail_with_reason(const std::string& problem) const;
};

/// A dataset with its shape and element type.
struct Dataset : Object {
  std::vector<std::int64_t> dims;
  H5T_class_t type_class = H5T_NO_CLASS;
  std::size_t type_size = 0;
  bool is_signed = false;

  std::int64_t rows() const { return dims.empty() ? 0 : dims[0]; }
};

/// The little-endian type in the file and the type in memory of a pixel type.
hid_t file_type_of(PixelType type);
hid_t memory_type_of(PixelType type);

}  // namespace tetwarp::h5
