/// @file h5_attribute.hpp
/// Reading attributes of HDF5 objects.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "io/h5/h5.hpp"

namespace tetwarp::h5 {

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

}  // namespace tetwarp::h5
