/// @file axes_option.hpp
/// The option --axes: world axes of files that are read or written.
#pragma once
#include <optional>
#include <string>

#include <tetwarp/io.hpp>

#include "host/cli/common/declare.hpp"

namespace tetwarp::cli {

/// Declares --axes ras|lps. Without the option `target` stays empty.
inline void add_axes(CLI::App& app, std::optional<Axes>& target, const std::string& description) {
  app.add_option_function<std::string>(
         "--axes",
         [&target](const std::string& word) {
           target = meaning_of("--axes", word, choices_of<Axes>());
         },
         description)
      ->type_name("ras|lps");
}

/// Axes for reading a mesh: those of the option. Throws IoError if they are given for a VTKHDF
/// mesh, whose axes are always as stored.
inline Axes axes_of_mesh(const std::string& path, const std::optional<Axes>& option) {
  if (option == Axes::lps && kind_of(path) == FileKind::mesh) {
    throw IoError(path, "",
                  "is a VTKHDF mesh, which is not turned; leave out --axes, which is for .msh, "
                  ".vtu and .vtk");
  }
  return option.value_or(Axes::ras);
}

}  // namespace tetwarp::cli
