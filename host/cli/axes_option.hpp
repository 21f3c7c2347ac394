/// @file axes_option.hpp
/// The option --axes of `tetwarp import` and `tetwarp export`.
#pragma once
#include <optional>
#include <string>

#include <tetwarp/axes.hpp>

#include "host/cli/declare.hpp"

namespace tetwarp::cli {

/// Declares --axes ras|lps; without it `target` stays empty, which `description` explains.
inline void add_axes(CLI::App& app, std::optional<Axes>& target, const std::string& description) {
  app.add_option_function<std::string>(
         "--axes",
         [&target](const std::string& word) {
           target = meaning_of("--axes", word, choices_of<Axes>());
         },
         description)
      ->type_name("ras|lps");
}

}  // namespace tetwarp::cli
