/// @file read_array.cpp
/// Reads an array, and says which one if none is named.
#include "host/cli/tools/read_array.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <vector>

#include "host/cli/common/declare.hpp"

namespace tetwarp::cli {

Volume read_array(const std::string& path,
                  const std::string& array,
                  std::optional<std::int64_t> step,
                  const VolumeReadOptions& options) {
  const VolumeReader reader(path, array, step.value_or(0), options);
  const std::string& name = reader.array().name;
  const std::vector<std::string> names = reader.array_names();
  if (array.empty() && names.size() > 1) {
    fmt::print(stderr, "tetwarp: {}: takes array {} of {}; --array names another\n", path, name,
               listed(names));
  }
  const std::size_t steps = read_volume_header(path, options).times.size();
  if (!step && steps > 1) {
    fmt::print(stderr, "tetwarp: {}: takes step 0 of {}; --step names another\n", path, steps);
  }
  return read_volume(path, name, step.value_or(0), options);
}

}  // namespace tetwarp::cli
