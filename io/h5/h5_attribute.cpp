/// @file h5_attribute.cpp
/// Reading attributes.
#include "io/h5/h5_attribute.hpp"

#include <algorithm>
#include <cmath>

#include "io/h5/h5.hpp"
#include "io/h5/h5_read.hpp"

namespace tetwarp::h5 {
namespace {
struct Attribute {
  Handle handle;
  Handle type;
  H5T_class_t type_class = H5T_NO_CLASS;
  std::size_t count = 0;
};

Attribute open_attribute(const Object& object, const std::string& name) {
  if (!has_attribute(object, name)) object.fail("missing attribute " + name);
  Attribute attribute;
  attribute.handle = Handle(H5Aopen(object.id(), name.c_str(), H5P_DEFAULT), H5Aclose);
  if (!attribute.handle) object.fail_with_reason("damaged attribute " + name);
  attribute.type = Handle(H5Aget_type(attribute.handle.id()), H5Tclose);
  const Handle space(H5Aget_space(attribute.handle.id()), H5Sclose);
  const hssize_t count = space ? H5Sget_simple_extent_npoints(space.id()) : -1;
  if (!attribute.type || count < 0) object.fail_with_reason("damaged attribute " + name);
  if (!is_sound(attribute.type)) object.fail("damaged type of attribute " + name);
  attribute.type_class = H5Tget_class(attribute.type.id());
  attribute.count = static_cast<std::size_t>(count);
  return attribute;
}

template <class T>
std::vector<T> read_attribute(const Object& object,
                              const std::string& name,
                              std::size_t count,
                              hid_t memory_type) {
  const Attribute attribute = open_attribute(object, name);
  const bool is_number = attribute.type_class == H5T_INTEGER || attribute.type_class == H5T_FLOAT;
  if (!is_number || attribute.count != count) {
    object.fail("attribute " + name + " holds " + std::to_string(attribute.count) +
                (is_number ? " numbers" : " values that are not numbers") + ", expected " +
                std::to_string(count) + (count == 1 ? " number" : " numbers"));
  }
  std::vector<T> values(count);
  if (H5Aread(attribute.handle.id(), memory_type, values.data()) < 0) {
    object.fail_with_reason("attribute " + name + " cannot be read");
  }
  return values;
}
}  // namespace

bool has_attribute(const Object& object, const std::string& name) {
  return H5Aexists(object.id(), name.c_str()) > 0;
}

std::vector<double> read_real_attribute(const Object& object,
                                        const std::string& name,
                                        std::size_t count) {
  return read_attribute<double>(object, name, count, H5T_NATIVE_DOUBLE);
}

std::vector<std::int64_t> read_integer_attribute(const Object& object,
                                                 const std::string& name,
                                                 std::size_t count) {
  std::vector<std::int64_t> whole;
  for (const double value : read_real_attribute(object, name, count)) {
    if (!(std::abs(value) <= 0x1p53) || value != std::trunc(value)) {
      object.fail("attribute " + name + " holds " + std::to_string(value) +
                  ", expected whole numbers up to 2^53");
    }
    whole.push_back(static_cast<std::int64_t>(value));
  }
  return whole;
}

std::string read_text_attribute(const Object& object, const std::string& name) {
  const Attribute attribute = open_attribute(object, name);
  if (attribute.type_class != H5T_STRING || attribute.count != 1) {
    object.fail("attribute " + name + " is not one string");
  }
  if (H5Tis_variable_str(attribute.type.id()) > 0) {
    char* text = nullptr;
    if (H5Aread(attribute.handle.id(), attribute.type.id(), &text) < 0) {
      object.fail_with_reason("attribute " + name + " cannot be read");
    }
    std::string copy = text == nullptr ? "" : text;
    H5free_memory(text);
    return copy;
  }
  const std::size_t size = H5Tget_size(attribute.type.id());
  if (size > 65536)
    object.fail("attribute " + name + " has " + std::to_string(size) +
                " bytes, expected at most 65536");
  std::string text(size, '\0');
  if (H5Aread(attribute.handle.id(), attribute.type.id(), text.data()) < 0) {
    object.fail_with_reason("attribute " + name + " cannot be read");
  }
  text.resize(std::min(text.size(), text.find('\0')));
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

}  // namespace tetwarp::h5
