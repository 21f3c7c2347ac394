/// @file h5_write.cpp
/// Writing: every failure is an IoError under the name the caller gave the file.
#include "io/h5/h5_write.hpp"

#include "io/h5/h5.hpp"

namespace tetwarp::h5 {
namespace {
constexpr const char* write_problem = "cannot be written";

void write_values(const Object& object,
                  const std::string& name,
                  hid_t file_type,
                  hid_t memory_type,
                  const Handle& space,
                  const void* values) {
  const Handle attribute(
      H5Acreate2(object.id(), name.c_str(), file_type, space.id(), H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  if (!attribute || H5Awrite(attribute.id(), memory_type, values) < 0) {
    object.fail_with_reason("attribute " + name + " " + write_problem);
  }
}

template <class T>
void write_row(const Object& object,
               const std::string& name,
               hid_t file_type,
               hid_t memory_type,
               std::span<const T> values) {
  const hsize_t count = values.size();
  const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  write_values(object, name, file_type, memory_type, space, values.data());
}

Object create_group_with(const Object& parent, const std::string& name, hid_t properties) {
  Object group{parent.file, parent.name + "/" + name, {}};
  group.handle =
      Handle(H5Gcreate2(parent.id(), name.c_str(), H5P_DEFAULT, properties, H5P_DEFAULT), H5Gclose);
  if (!group.handle) group.fail_with_reason(write_problem);
  return group;
}
}  // namespace

Object create_group(const Object& parent, const std::string& name) {
  return create_group_with(parent, name, H5P_DEFAULT);
}

Object create_ordered_group(const Object& parent, const std::string& name) {
  const Handle properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  H5Pset_link_creation_order(properties.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  H5Pset_obj_track_times(properties.id(), false);  // the same content gives the same bytes
  return create_group_with(parent, name, properties.id());
}

Object create_dataset(
    const Object& parent, const std::string& name, hid_t file_type, hid_t space, hid_t properties) {
  Object dataset{parent.file, parent.name + "/" + name, {}};
  const Handle untimed(
      properties == H5P_DEFAULT ? H5Pcreate(H5P_DATASET_CREATE) : H5Pcopy(properties), H5Pclose);
  // The same content gives the same bytes: no times of creation inside.
  H5Pset_obj_track_times(untimed.id(), false);
  dataset.handle = Handle(H5Dcreate2(parent.id(), name.c_str(), file_type, space, H5P_DEFAULT,
                                     untimed.id(), H5P_DEFAULT),
                          H5Dclose);
  if (!dataset.handle) dataset.fail_with_reason(write_problem);
  return dataset;
}

Object write_dataset(const Object& parent,
                     const std::string& name,
                     hid_t file_type,
                     hid_t memory_type,
                     std::span<const hsize_t> dims,
                     const void* data) {
  const Handle space(H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr),
                     H5Sclose);
  Object dataset = create_dataset(parent, name, file_type, space.id(), H5P_DEFAULT);
  if (H5Dwrite(dataset.id(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0) {
    dataset.fail_with_reason(write_problem);
  }
  return dataset;
}

void write_attribute(const Object& object,
                     const std::string& name,
                     std::span<const double> values) {
  write_row(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values);
}

void write_attribute(const Object& object,
                     const std::string& name,
                     std::span<const std::int64_t> values) {
  write_row(object, name, H5T_STD_I64LE, H5T_NATIVE_INT64, values);
}

void write_attribute(const Object& object,
                     const std::string& name,
                     std::span<const std::int32_t> values) {
  write_row(object, name, H5T_STD_I32LE, H5T_NATIVE_INT32, values);
}

void write_scalar_attribute(const Object& object, const std::string& name, std::int64_t value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  write_values(object, name, H5T_STD_I64LE, H5T_NATIVE_INT64, space, &value);
}

void write_scalar_attribute(const Object& object, const std::string& name, double value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  write_values(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, space, &value);
}

void write_text_attribute(const Object& object, const std::string& name, const std::string& text) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  if (H5Tset_size(type.id(), text.size()) < 0 || H5Tset_strpad(type.id(), H5T_STR_NULLPAD) < 0) {
    object.fail_with_reason("attribute " + name + " cannot be an empty text");
  }
  write_values(object, name, type.id(), type.id(), space, text.data());
}

}  // namespace tetwarp::h5
