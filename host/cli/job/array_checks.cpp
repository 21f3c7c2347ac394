/// @file array_checks.cpp
/// The checks of the arrays of a volume.
#include "host/cli/job/array_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "host/cli/common/declare.hpp"
#include "host/warp/transform_checks.hpp"
#include "io/files/component_facts.hpp"

namespace tetwarp::cli {
namespace {
void check_named(const std::string& path,
                 const std::vector<ArrayHeader>& arrays,
                 const std::string& name,
                 Quantity quantity) {
  const auto is_named = [&](const ArrayHeader& array) { return array.name == name; };
  if (std::ranges::any_of(arrays, is_named)) return;
  throw IoError(path, name,
                fmt::format("{}: no such array among those to warp; tetwarp info lists all arrays",
                            quantity < Quantity::tensor ? "--vectors" : "--tensors"));
}

/// Only files of a single array have such facts.
void check_facts(const std::string& path, const VolumeHeader& header, Quantity quantity) {
  const auto is_left_out = [&](const char* fact) {
    return std::ranges::count(header.left_out, fact) > 0;
  };
  if (is_left_out(frame_fact)) {
    throw IoError(
        path, frame_fact,
        "turns the components, which is not read; write them along the axes of the space");
  }
  if (quantity >= Quantity::tensor && is_left_out(order_fact)) {
    throw IoError(path, "kinds",
                  "tells another order of the six components than xx yy zz xy yz xz, which is not "
                  "read; write NIfTI of intent code 1005");
  }
}
}  // namespace

std::vector<ArrayHeader> choose_arrays(const VolumeHeader& header,
                                       const WarpArguments& arguments,
                                       const std::string& path) {
  std::vector<ArrayHeader> chosen;
  std::vector<std::string> names;
  for (const ArrayHeader& array : header.arrays) {
    names.push_back(array.name);
    if (arguments.arrays.empty() && !array.name.starts_with("tetwarp_")) chosen.push_back(array);
  }
  for (const std::string& name : arguments.arrays) {
    const auto is_named = [&](const ArrayHeader& array) { return array.name == name; };
    const auto found = std::find_if(header.arrays.begin(), header.arrays.end(), is_named);
    if (found == header.arrays.end()) {
      throw IoError(path, name, "no such array; the file has " + listed(names));
    }
    if (std::find_if(chosen.begin(), chosen.end(), is_named) == chosen.end()) {
      chosen.push_back(*found);
    }
  }
  if (chosen.empty()) throw IoError(path, "", "holds no array to warp");
  return chosen;
}

void check_arrays(const std::string& path,
                  const VolumeHeader& header,
                  const std::vector<ArrayHeader>& arrays,
                  const WarpArguments& arguments) {
  for (const auto& [name, quantity] : arguments.quantities) {
    check_named(path, arrays, name, quantity);
    check_facts(path, header, quantity);
  }
  for (const ArrayHeader& array : arrays) {
    try {
      check_source_transform({header.grid, array.type, array.components, nullptr, Memory::host},
                             arguments.quantity_of(array.name), arguments.warp);
    } catch (const std::invalid_argument& error) {
      throw IoError(path, array.name,
                    fmt::format("{} (--array chooses other arrays)", error.what()));
    }
    for (const std::size_t e : arguments.extra) {
      if (array.name == extra_outputs[e].array()) {
        throw IoError(path, array.name, "an extra output has this name; leave out one of them");
      }
    }
  }
}

}  // namespace tetwarp::cli
