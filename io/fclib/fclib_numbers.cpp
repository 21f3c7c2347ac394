/// @file fclib_numbers.cpp
/// Numbers and texts of FCLIB files. Shapes of datasets are ignored: programs store one number as a
/// scalar or as [1], and three per contact as [3 n] or [n][3].
#include "io/fclib/fclib_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tetwarp/error.hpp>

#include "io/h5/h5_write.hpp"

namespace tetwarp::fclib {
namespace {
constexpr std::int64_t largest_index = std::numeric_limits<std::int32_t>::max();

template <class T>
std::vector<T> read_all(const h5::Dataset& dataset, hid_t memory_type) {
  const std::int64_t count = element_count(dataset);
  h5::check_memory(dataset.file, dataset.name, sizeof(T) * static_cast<double>(count));
  std::vector<T> values(static_cast<std::size_t>(count));
  if (!values.empty() &&
      H5Dread(dataset.id(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
    dataset.fail_with_reason("cannot be read, the file may be truncated or damaged");
  }
  return values;
}

h5::Dataset open_integers(const h5::Object& parent, const std::string& name) {
  h5::Dataset dataset = h5::open_dataset(parent, name);
  if (!h5::is_numeric(dataset) || dataset.type_class != H5T_INTEGER) {
    dataset.fail("expected integers");
  }
  return dataset;
}

/// Checked here, where an index is that in the file: sorting a matrix by rows changes indices.
std::vector<double> read_finite(const h5::Dataset& dataset) {
  std::vector<double> values = read_all<double>(dataset, H5T_NATIVE_DOUBLE);
  const auto bad = std::find_if_not(values.begin(), values.end(),
                                    [](double value) { return std::isfinite(value); });
  if (bad != values.end()) {
    dataset.fail("entry " + std::to_string(bad - values.begin()) + " is " + std::to_string(*bad) +
                 ", expected finite numbers");
  }
  return values;
}

/// The bytes of a text of fixed or variable length.
std::string read_bytes(const h5::Handle& dataset, const h5::Handle& type) {
  constexpr std::size_t longest_text = 65536;
  if (H5Tis_variable_str(type.id()) > 0) {
    char* bytes = nullptr;
    if (H5Dread(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, &bytes) < 0) return {};
    std::string text = bytes == nullptr ? "" : bytes;
    H5free_memory(bytes);
    return text;
  }
  const std::size_t size = H5Tget_size(type.id());
  if (size > longest_text) return {};
  std::string text(size, '\0');
  if (H5Dread(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) < 0) return {};
  text.resize(std::min(text.size(), text.find('\0')));
  return text;
}
}  // namespace

std::int64_t element_count(const h5::Dataset& dataset) {
  if (!h5::is_numeric(dataset)) dataset.fail("holds no numbers");
  if (dataset.dims.empty()) {
    const h5::Handle space(H5Dget_space(dataset.id()), H5Sclose);
    return H5Sget_simple_extent_type(space.id()) == H5S_SCALAR ? 1 : 0;
  }
  double count = 1;
  for (const std::int64_t dim : dataset.dims) count *= static_cast<double>(dim);
  if (count > static_cast<double>(largest_index)) {
    dataset.fail("holds more than 2^31 - 1 numbers, split the problem");
  }
  return static_cast<std::int64_t>(count);
}

std::int64_t read_integer(const h5::Object& parent, const std::string& name) {
  const h5::Dataset dataset = open_integers(parent, name);
  if (element_count(dataset) != 1) {
    dataset.fail("holds " + std::to_string(element_count(dataset)) + " numbers, expected one");
  }
  return read_all<std::int64_t>(dataset, H5T_NATIVE_INT64).front();
}

std::vector<std::int64_t> read_integers(const h5::Object& parent, const std::string& name) {
  return read_all<std::int64_t>(open_integers(parent, name), H5T_NATIVE_INT64);
}

std::vector<double> read_reals(const h5::Object& parent, const std::string& name) {
  return read_finite(h5::open_dataset(parent, name));
}

std::vector<double> read_reals(const h5::Object& parent,
                               const std::string& name,
                               const Expected& expected) {
  const h5::Dataset dataset = h5::open_dataset(parent, name);
  if (element_count(dataset) != expected.count) {
    dataset.fail("holds " + std::to_string(element_count(dataset)) + " numbers, expected " +
                 std::to_string(expected.count) + ": " + expected.reason);
  }
  return read_finite(dataset);
}

std::string read_text(const h5::Object& parent, const std::string& name) {
  if (!h5::has_child(parent, name) || h5::is_group(parent, name)) return {};
  const h5::Handle dataset(H5Dopen2(parent.id(), name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!dataset) return {};
  const h5::Handle type(H5Dget_type(dataset.id()), H5Tclose);
  const h5::Handle space(H5Dget_space(dataset.id()), H5Sclose);
  const bool is_one_text = type && space && H5Tget_class(type.id()) == H5T_STRING &&
                           H5Sget_simple_extent_npoints(space.id()) == 1;
  return is_one_text ? read_bytes(dataset, type) : "";
}

void write_integers(const h5::Object& parent,
                    const std::string& name,
                    const std::vector<std::int64_t>& values) {
  for (const std::int64_t value : values) {
    if (value < -largest_index || value > largest_index) {
      throw IoError(parent.file, parent.name + "/" + name,
                    std::to_string(value) +
                        " does not fit FCLIB's 32-bit integers, split the "
                        "problem");
    }
  }
  const hsize_t count = values.size();
  h5::write_dataset(parent, name, H5T_STD_I32LE, H5T_NATIVE_INT64, {&count, 1}, values.data());
}

void write_reals(const h5::Object& parent,
                 const std::string& name,
                 const std::vector<double>& values) {
  const hsize_t count = values.size();
  h5::write_dataset(parent, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, {&count, 1}, values.data());
}

void write_text(const h5::Object& parent, const std::string& name, const std::string& text) {
  const h5::Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const h5::Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id(), text.size() + 1);  // with the final zero, as FCLIB's reader expects it
  const h5::Object dataset = h5::create_dataset(parent, name, type.id(), space.id(), H5P_DEFAULT);
  if (H5Dwrite(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()) < 0) {
    dataset.fail_with_reason("cannot be written");
  }
}

}  // namespace tetwarp::fclib
