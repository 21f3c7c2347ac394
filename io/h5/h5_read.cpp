/// @file h5_read.cpp
/// Reading: nothing is allocated before its size was compared with the file and the memory.
#include "io/h5/h5_read.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <tetwarp/error.hpp>

#include "io/h5/h5_disk.hpp"

namespace tetwarp::h5 {
namespace {
std::string child_path(const Object& parent, const std::string& name) {
  return parent.name + "/" + name;
}

bool has_link(const Object& parent, const std::string& name) {
  return H5Lexists(parent.id(), name.c_str(), H5P_DEFAULT) > 0;
}

bool is_there(const Object& parent, const std::string& name) {
  return has_link(parent, name) && H5Oexists_by_name(parent.id(), name.c_str(), H5P_DEFAULT) > 0;
}

/// Where a soft or external link leads, in words; empty: it is no such link.
std::string target_of_link(const Object& parent, const std::string& name) {
  H5L_info_t link{};
  if (H5Lget_info(parent.id(), name.c_str(), &link, H5P_DEFAULT) < 0) return {};
  if (link.type != H5L_TYPE_SOFT && link.type != H5L_TYPE_EXTERNAL) return {};
  std::string value(link.u.val_size + 1, '\0');
  if (H5Lget_val(parent.id(), name.c_str(), value.data(), link.u.val_size, H5P_DEFAULT) < 0) {
    return {};
  }
  if (link.type == H5L_TYPE_SOFT) return "'" + std::string(value.c_str()) + "'";
  const char *file = nullptr, *object = nullptr;
  if (H5Lunpack_elink_val(value.data(), link.u.val_size, nullptr, &file, &object) < 0) return {};
  return "'" + std::string(object) + "' in the file '" + file + "'";
}

[[noreturn]] void fail_missing(const Object& parent, const std::string& name, const char* kind) {
  std::string there;
  for (const std::string& child : child_names(parent)) there += (there.empty() ? "" : ", ") + child;
  throw IoError(parent.file, child_path(parent, name),
                std::string("missing ") + kind + ", '" + (parent.name.empty() ? "/" : parent.name) +
                    "' holds " + (there.empty() ? "nothing" : there));
}

/// The name or number of a filter of a dataset that the HDF5 library does not have; empty: none.
std::string missing_filter(const Dataset& dataset) {
  const Handle properties(H5Dget_create_plist(dataset.id()), H5Pclose);
  if (!properties) return {};
  for (int k = 0; k < H5Pget_nfilters(properties.id()); ++k) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    std::array<char, 64> name{};
    const H5Z_filter_t filter =
        H5Pget_filter2(properties.id(), static_cast<unsigned>(k), &flags, &values, nullptr,
                       name.size() - 1, name.data(), &config);
    if (filter < 0 || H5Zfilter_avail(filter) > 0) continue;
    return name[0] != 0 ? "'" + std::string(name.data()) + "'" : std::to_string(filter);
  }
  return {};
}

/// Throws when a dataset claims more than its file holds: a cut file, or damaged sizes.
void check_storage(const Dataset& dataset) {
  const Handle properties(H5Dget_create_plist(dataset.id()), H5Pclose);
  if (!properties) dataset.fail_with_reason("damaged description");
  if (H5Pget_external_count(properties.id()) > 0) return;
  // Of the file that is open: its name may be that of another one, which it will replace.
  const Handle file(H5Iget_file_id(dataset.id()), H5Fclose);
  hsize_t file_bytes = 0;
  if (!file || H5Fget_filesize(file.id(), &file_bytes) < 0) return;
  const H5D_layout_t layout = H5Pget_layout(properties.id());
  if (layout == H5D_VIRTUAL) return;  // its samples are in other files
  check_memory(dataset.file, dataset.name, chunk_bytes(dataset));
  const hsize_t stored = H5Dget_storage_size(dataset.id());
  auto claimed = static_cast<double>(dataset.type_size);
  for (const std::int64_t dim : dataset.dims) claimed *= static_cast<double>(dim);
  if (claimed == 0) return;
  const haddr_t begin = layout == H5D_CONTIGUOUS ? H5Dget_offset(dataset.id()) : 0;
  if (begin == HADDR_UNDEF) dataset.fail("was never written, write the file again");
  const bool is_cut = layout != H5D_CHUNKED && static_cast<double>(stored) < claimed;
  if (is_cut || stored > file_bytes || begin > file_bytes - stored) {
    dataset.fail("the file of " + std::to_string(file_bytes) +
                 " bytes does not hold all of it: truncated or damaged, copy it again");
  }
}

std::vector<std::string> names_by(const Object& group, H5_index_t order) {
  std::vector<std::string> names;
  const auto append = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  if (H5Literate(group.id(), order, H5_ITER_INC, nullptr, append, &names) < 0) {
    group.fail_with_reason("damaged group");
  }
  return names;
}

template <class T>
std::vector<T> read_column(const Dataset& dataset, hid_t memory_type) {
  if (!is_numeric(dataset)) dataset.fail("holds no numbers");
  const bool is_column =
      dataset.dims.size() == 1 || (dataset.dims.size() == 2 && dataset.dims[1] == 1);
  if (!is_column) dataset.fail("expected shape [n] or [n][1]");
  check_memory(dataset.file, dataset.name, 8.0 * static_cast<double>(dataset.rows()));
  std::vector<T> values(static_cast<std::size_t>(dataset.rows()));
  const std::vector<std::int64_t> start(dataset.dims.size(), 0);
  read_block(dataset, memory_type, start, dataset.dims, values.data());
  return values;
}

/// True for an enumeration of one byte with the names FALSE for 0 and TRUE for 1: h5py's booleans.
bool is_boolean(const Handle& type) {
  if (H5Tget_class(type.id()) != H5T_ENUM || H5Tget_size(type.id()) != 1 ||
      H5Tget_nmembers(type.id()) != 2) {
    return false;
  }
  std::uint8_t off = 1, on = 0;
  return H5Tenum_valueof(type.id(), "FALSE", &off) >= 0 &&
         H5Tenum_valueof(type.id(), "TRUE", &on) >= 0 && off == 0 && on == 1;
}

/// The type of the elements of a dataset, of an enumeration that of its numbers.
Handle number_type(const Dataset& dataset, const Handle& type) {
  const bool is_enum = H5Tget_class(type.id()) == H5T_ENUM;
  Handle numbers(is_enum ? H5Tget_super(type.id()) : H5Tcopy(type.id()), H5Tclose);
  if (!numbers || !is_sound(numbers)) dataset.fail("damaged type of its elements");
  return numbers;
}
}  // namespace

bool is_sound(const Handle& type) {
  const std::size_t bits = 8 * H5Tget_size(type.id());
  const H5T_class_t type_class = H5Tget_class(type.id());
  if (type_class != H5T_INTEGER && type_class != H5T_FLOAT) return true;
  const std::size_t precision = H5Tget_precision(type.id());
  const int offset = H5Tget_offset(type.id());
  if (offset < 0 || precision > bits || static_cast<std::size_t>(offset) > bits - precision) {
    return false;
  }
  if (type_class == H5T_INTEGER) return true;
  std::size_t sign = 0, exponent = 0, exponent_bits = 0, mantissa = 0, mantissa_bits = 0;
  if (H5Tget_fields(type.id(), &sign, &exponent, &exponent_bits, &mantissa, &mantissa_bits) < 0) {
    return false;
  }
  return sign < bits && exponent + exponent_bits <= bits && mantissa + mantissa_bits <= bits;
}

Object open_file(const std::string& path) {
  Object file{path, "", {}};
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) {
    file.fail(std::string("cannot be opened: ") + std::strerror(errno));
  }
  if (!S_ISREG(status.st_mode)) file.fail("is not a plain file");
  const htri_t is_hdf5 = H5Fis_hdf5(path.c_str());
  if (is_hdf5 < 0) file.fail_with_reason("cannot be opened");
  if (is_hdf5 == 0) file.fail("is not an HDF5 file");
  const Handle access = disk_access(nullptr);
  file.handle = Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose);
  if (!file.handle) {
    file.fail_with_reason("truncated or damaged HDF5 file, copy or write it again");
  }
  return file;
}

bool has_child(const Object& parent, const std::string& name) {
  if (is_there(parent, name)) return true;
  const std::string target = has_link(parent, name) ? target_of_link(parent, name) : "";
  if (target.empty()) return false;
  throw IoError(parent.file, child_path(parent, name),
                "is a link to " + target +
                    ", which is not there or cannot be opened; put it there, or remove the link");
}

std::vector<std::string> child_names(const Object& parent) {
  std::vector<std::string> names = names_by(parent, H5_INDEX_NAME);
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> child_names_as_created(const Object& group) {
  const Handle properties(H5Gget_create_plist(group.id()), H5Pclose);
  unsigned flags = 0;
  const bool is_tracked = properties && H5Pget_link_creation_order(properties.id(), &flags) >= 0 &&
                          (flags & H5P_CRT_ORDER_TRACKED) != 0;
  return is_tracked ? names_by(group, H5_INDEX_CRT_ORDER) : child_names(group);
}

bool is_group(const Object& parent, const std::string& name) {
  if (!is_there(parent, name)) return false;
  const Handle object(H5Oopen(parent.id(), name.c_str(), H5P_DEFAULT), H5Oclose);
  return object && H5Iget_type(object.id()) == H5I_GROUP;
}

Object open_group(const Object& parent, const std::string& name) {
  if (!has_child(parent, name) || !is_group(parent, name)) fail_missing(parent, name, "group");
  Object group{parent.file, child_path(parent, name), {}};
  group.handle = Handle(H5Gopen2(parent.id(), name.c_str(), H5P_DEFAULT), H5Gclose);
  if (!group.handle) group.fail_with_reason("damaged group");
  return group;
}

Dataset open_dataset(const Object& parent, const std::string& name) {
  if (!has_child(parent, name)) fail_missing(parent, name, "dataset");
  Dataset dataset;
  dataset.file = parent.file;
  dataset.name = child_path(parent, name);
  dataset.handle = Handle(H5Dopen2(parent.id(), name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!dataset.handle) dataset.fail_with_reason("is not a readable dataset");
  const Handle space(H5Dget_space(dataset.id()), H5Sclose);
  const Handle type(H5Dget_type(dataset.id()), H5Tclose);
  const int rank = space ? H5Sget_simple_extent_ndims(space.id()) : -1;
  if (rank < 0 || !type) dataset.fail_with_reason("damaged description");
  std::vector<hsize_t> dims(static_cast<std::size_t>(rank));
  if (rank > 0 && H5Sget_simple_extent_dims(space.id(), dims.data(), nullptr) < 0) {
    dataset.fail_with_reason("damaged description");
  }
  for (const hsize_t dim : dims) {
    if (dim > hsize_t{1} << 60)
      dataset.fail("has a dimension of " + std::to_string(dim) +
                   ", expected at most 2^60: damaged");
    dataset.dims.push_back(static_cast<std::int64_t>(dim));
  }
  const Handle numbers = number_type(dataset, type);
  dataset.type_class = H5Tget_class(numbers.id());
  dataset.type_size = H5Tget_size(numbers.id());
  dataset.is_signed = dataset.type_class == H5T_INTEGER && H5Tget_sign(numbers.id()) == H5T_SGN_2 &&
                      !is_boolean(type);
  check_storage(dataset);
  return dataset;
}

double chunk_bytes(const Dataset& dataset) {
  const Handle properties(H5Dget_create_plist(dataset.id()), H5Pclose);
  if (!properties || H5Pget_layout(properties.id()) != H5D_CHUNKED) return 0;
  std::vector<hsize_t> chunk(dataset.dims.size());
  const int rank = static_cast<int>(chunk.size());
  if (H5Pget_chunk(properties.id(), rank, chunk.data()) != rank) {
    dataset.fail_with_reason("damaged chunk sizes");
  }
  auto bytes = static_cast<double>(dataset.type_size);
  for (const hsize_t edge : chunk) bytes *= static_cast<double>(edge);
  return bytes;
}

bool is_numeric(const Dataset& dataset) {
  const std::size_t size = dataset.type_size;
  if (dataset.type_class == H5T_FLOAT) return size <= 8;
  return dataset.type_class == H5T_INTEGER && (size == 1 || size == 2 || size == 4 || size == 8);
}

PixelType pixel_type_of(const Dataset& dataset) {
  if (!is_numeric(dataset)) {
    dataset.fail(
        "holds elements of " + std::to_string(dataset.type_size) +
        " bytes that are not numbers of 1, 2, 4 or 8 bytes; write plain integers or floats");
  }
  if (dataset.type_class == H5T_FLOAT) {
    return dataset.type_size <= 4 ? PixelType::float32 : PixelType::float64;
  }
  switch (dataset.type_size) {
    case 1:
      return dataset.is_signed ? PixelType::int8 : PixelType::uint8;
    case 2:
      return dataset.is_signed ? PixelType::int16 : PixelType::uint16;
    case 4:
      return dataset.is_signed ? PixelType::int32 : PixelType::uint32;
    default:
      return dataset.is_signed ? PixelType::int64 : PixelType::uint64;
  }
}

void read_block(const Dataset& dataset,
                hid_t memory_type,
                std::span<const std::int64_t> start,
                std::span<const std::int64_t> count,
                void* out) {
  const std::vector<hsize_t> first(start.begin(), start.end());
  const std::vector<hsize_t> edges(count.begin(), count.end());
  if (std::find(edges.begin(), edges.end(), 0) != edges.end()) return;
  const Handle file_space(H5Dget_space(dataset.id()), H5Sclose);
  const Handle memory_space(H5Screate_simple(static_cast<int>(edges.size()), edges.data(), nullptr),
                            H5Sclose);
  if (!file_space || !memory_space ||
      H5Sselect_hyperslab(file_space.id(), H5S_SELECT_SET, first.data(), nullptr, edges.data(),
                          nullptr) < 0 ||
      H5Dread(dataset.id(), memory_type, memory_space.id(), file_space.id(), H5P_DEFAULT, out) <
          0) {
    if (const std::string filter = missing_filter(dataset); !filter.empty()) {
      dataset.fail(
          "is compressed by the filter " + filter +
          ", which this HDF5 library does not have; write it with gzip or without a filter");
    }
    dataset.fail_with_reason("cannot be read, the file may be truncated or damaged");
  }
}

std::vector<std::int64_t> read_integers(const Dataset& dataset) {
  if (dataset.type_class != H5T_INTEGER) dataset.fail("expected integers");
  return read_column<std::int64_t>(dataset, H5T_NATIVE_INT64);
}

std::vector<double> read_reals(const Dataset& dataset) {
  return read_column<double>(dataset, H5T_NATIVE_DOUBLE);
}

std::string read_text(const Dataset& dataset) {
  const Handle type(H5Dget_type(dataset.id()), H5Tclose);
  std::int64_t count = 1;
  for (const std::int64_t dim : dataset.dims) count *= std::min<std::int64_t>(dim, 2);
  if (dataset.type_class != H5T_STRING || count != 1) dataset.fail("is not one string");
  if (H5Tis_variable_str(type.id()) > 0) {
    char* text = nullptr;
    if (H5Dread(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, &text) < 0) {
      dataset.fail_with_reason("cannot be read");
    }
    std::string copy = text == nullptr ? "" : text;
    H5free_memory(text);
    return copy;
  }
  if (dataset.type_size > 65536) dataset.fail("is longer than 65536 bytes");
  std::string text(dataset.type_size, '\0');
  if (H5Dread(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) < 0) {
    dataset.fail_with_reason("cannot be read");
  }
  text.resize(std::min(text.size(), text.find('\0')));
  return text;
}

}  // namespace tetwarp::h5
