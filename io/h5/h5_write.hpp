/// @file h5_write.hpp
/// Writing HDF5 groups, datasets and attributes.
#pragma once
#include <cstdint>
#include <span>
#include <string>

#include <hdf5.h>

#include "io/h5/h5.hpp"

namespace tetwarp::h5 {

Object create_group(const Object& parent, const std::string& name);

/// Creates a group that tracks the order in which its children are created.
Object create_ordered_group(const Object& parent, const std::string& name);

/// Creates a dataset; `properties` may be H5P_DEFAULT.
Object create_dataset(
    const Object& parent, const std::string& name, hid_t file_type, hid_t space, hid_t properties);

/// Creates a dataset of the given shape and writes all of it.
Object write_dataset(const Object& parent,
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

}  // namespace tetwarp::h5
