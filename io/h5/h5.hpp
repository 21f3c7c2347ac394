/// @file h5.hpp
/// HDF5 handles that close themselves, and reads and writes whose failures name file and dataset.
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

// ---- reading: h5_read.cpp ----

/// False for a number type of a damaged file whose bits lie outside its bytes: HDF5 would convert
/// it without a check, beyond the end of its buffer.
bool is_sound(const Handle& type);

/// Opens a file for reading. Throws IoError when it is missing, no HDF5 or damaged.
Object open_file(const std::string& path);

/// True when `parent` holds something readable called `name`.
bool has_child(const Object& parent, const std::string& name);

/// Names of all children, sorted.
std::vector<std::string> child_names(const Object& parent);

/// Names of all children in the order in which they were created, where the group tracks it, else
/// sorted.
std::vector<std::string> child_names_as_created(const Object& group);

/// True when the child is a group.
bool is_group(const Object& parent, const std::string& name);

/// Opens a group. Throws IoError when it is missing.
Object open_group(const Object& parent, const std::string& name);

/// Opens a dataset. Throws IoError when it is missing, or larger than the file that should hold it.
Dataset open_dataset(const Object& parent, const std::string& name);

/// The pixel type nearest to the elements of a dataset: integers of 1, 2, 4, 8 bytes and floats up
/// to 8, in any byte order, and booleans as h5py stores them, which are uint8. Throws IoError for
/// strings, compounds and the like.
PixelType pixel_type_of(const Dataset& dataset);

/// True when pixel_type_of() does not throw.
bool is_numeric(const Dataset& dataset);

/// Reads `count` elements per axis from `start` on, converted to `memory_type`.
void read_block(const Dataset& dataset,
                hid_t memory_type,
                std::span<const std::int64_t> start,
                std::span<const std::int64_t> count,
                void* out);

/// Bytes of a chunk of a dataset, unpacked; 0 where it has none.
double chunk_bytes(const Dataset& dataset);

/// Reads a dataset of integers of shape [n] or [n][1].
std::vector<std::int64_t> read_integers(const Dataset& dataset);

/// Reads a dataset of numbers of shape [n] or [n][1].
std::vector<double> read_reals(const Dataset& dataset);

// ---- attributes: h5_attribute.cpp ----

bool has_attribute(const Object& object, const std::string& name);

/// Reads an attribute of `count` numbers. Throws IoError when it is missing or of another length.
std::vector<double> read_real_attribute(const Object& object,
                                        const std::string& name,
                                        std::size_t count);

/// The same for whole numbers of magnitude up to 2^53, stored as integers or floats.
std::vector<std::int64_t> read_integer_attribute(const Object& object,
                                                 const std::string& name,
                                                 std::size_t count);

/// Reads a string attribute of fixed or variable length. Throws IoError when there is none.
std::string read_text_attribute(const Object& object, const std::string& name);

// ---- writing: h5_write.cpp ----

Object create_group(const Object& parent, const std::string& name);

/// Creates a group that tracks the order in which its children are created.
Object create_ordered_group(const Object& parent, const std::string& name);

/// Creates a dataset; `properties` may be H5P_DEFAULT.
Object create_dataset(
    const Object& parent, const std::string& name, hid_t file_type, hid_t space, hid_t properties);

/// Creates a dataset of the given shape and writes all of it.
void write_dataset(const Object& parent,
                   const std::string& name,
                   hid_t file_type,
                   hid_t memory_type,
                   std::span<const hsize_t> dims,
                   const void* data);

void write_attribute(const Object& object, const std::string& name, std::span<const double> values);
void write_attribute(const Object& object,
                     const std::string& name,
                     std::span<const std::int64_t> values);
void write_attribute(const Object& object,
                     const std::string& name,
                     std::span<const std::int32_t> values);

/// Writes one number as a scalar attribute.
void write_scalar_attribute(const Object& object, const std::string& name, std::int64_t value);
void write_scalar_attribute(const Object& object, const std::string& name, double value);

/// Writes a scalar ASCII string of exactly its length: ParaView refuses any other kind.
void write_text_attribute(const Object& object, const std::string& name, const std::string& text);

/// The little-endian type in the file and the type in memory of a pixel type.
hid_t file_type_of(PixelType type);
hid_t memory_type_of(PixelType type);

}  // namespace tetwarp::h5
