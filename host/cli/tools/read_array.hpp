/// @file read_array.hpp
/// The array of a volume file that a subcommand uses.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include <tetwarp/io.hpp>

namespace tetwarp::cli {

/// Reads an array of a volume file as read_volume() does. Where no array or no step is named and
/// the file has several, prints to standard error which one is taken.
Volume read_array(const std::string& path,
                  const std::string& array,
                  std::optional<std::int64_t> step,
                  const VolumeReadOptions& options = {});

}  // namespace tetwarp::cli
