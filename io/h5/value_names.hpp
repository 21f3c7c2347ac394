/// @file value_names.hpp
/// Names of the values of an array, as a text attribute of its dataset.
#pragma once
#include <cstdint>
#include <map>
#include <string>

#include "io/h5/h5.hpp"

namespace tetwarp {

/// Longest text of names in a file [byte]: HDF5 holds attributes up to 64 KiB.
inline constexpr std::size_t max_value_names = 60000;

/// One line per value: number, space, name. Line breaks within names become spaces.
std::string text_of_names(const std::map<std::int64_t, std::string>& names);

/// Writes the attribute `tetwarp_value_names` unless there are no names.
/// @throws IoError when they take more than max_value_names
void write_value_names(const h5::Object& dataset, const std::map<std::int64_t, std::string>& names);

/// @returns no names where the attribute is missing
/// @throws IoError when a line is not a number and a name
std::map<std::int64_t, std::string> read_value_names(const h5::Object& dataset);

}  // namespace tetwarp
