/// @file array_checks.cpp
#include "host/cli/array_checks.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace tetwarp::cli {

namespace {

void check_components(const std::string& path,
                      const std::vector<ArrayHeader>& arrays,
                      const std::string& name,
                      Quantity quantity) {
  const int components = quantity < Quantity::tensor ? 3 : 6;
  const char* const option = components == 3 ? "--vectors" : "--tensors";
  const auto is_named = [&](const ArrayHeader& array) { return array.name == name; };
  const auto found = std::ranges::find_if(arrays, is_named);
  if (found == arrays.end()) {
    throw IoError(path, name,
                  fmt::format("{} names no array that is warped; tetwarp info lists them", option));
  }
  if (found->components != components) {
    throw IoError(path, name,
                  fmt::format("{} wants {} components, the array has {}; leave the option out",
                              option, components, found->components));
  }
}

}  // namespace

void check_quantities(const std::string& path,
                      const std::vector<ArrayHeader>& arrays,
                      const WarpArguments& arguments) {
  for (const auto& [name, quantity] : arguments.quantities) {
    check_components(path, arrays, name, quantity);
  }
  for (const ArrayHeader& array : arrays) {
    const bool is_computed = arguments.warp.intensity != Intensity::value ||
                             arguments.quantity_of(array.name) != Quantity::components;
    const bool is_label = arguments.warp.filter == Filter::labels;
    if (is_computed && (is_label || (is_integer(array.type) && size_of(array.type) == 8))) {
      throw IoError(path, array.name,
                    fmt::format("{} cannot be scaled or turned; leave out --intensity, --vectors "
                                "and --tensors, or choose others with --array",
                                is_label ? "labels" : name_of(array.type)));
    }
  }
}

}  // namespace tetwarp::cli
