/// @file h5_read.hpp
/// Reading HDF5 files, groups and datasets.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <hdf5.h>
#include <tetwarp/volume.hpp>

#include "io/h5/h5.hpp"

namespace tetwarp::h5 {

/// False for a number type of a damaged file whose bits lie outside its bytes: HDF5 would convert
/// it without a check, beyond the end of its buffer.
bool is_sound(const Handle& type);

/// Opens a file for reading. Throws IoError when it is missing, no HDF5 or damaged.
Object open_file(const std::string& path);

/// True when `parent` holds something readable called `name`. Throws IoError for a link that leads
/// nowhere.
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
/// to 8, in any byte order, enumerations as their integers, and booleans as h5py stores them, which
/// are uint8. Throws IoError for strings, compounds and the like.
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

/// Reads a dataset of one string of fixed or variable length, at most 65536 bytes if fixed.
std::string read_text(const Dataset& dataset);

}  // namespace tetwarp::h5
