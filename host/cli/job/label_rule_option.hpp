/// @file label_rule_option.hpp
/// Option --label-rule.
#pragma once
#include <CLI/CLI.hpp>

#include <tetwarp/warp.hpp>

namespace tetwarp::cli {

/// Declares --label-rule linear|volume|gaussian[:SIGMA[:CUTOFF]], which sets
/// WarpOptions::label_rule and label_gaussian.
void declare_label_rule(CLI::App& app, WarpOptions& warp);

/// @throws CLI::ValidationError for a rule and options that do not go together
void check_label_rule(const WarpOptions& warp);

}  // namespace tetwarp::cli
