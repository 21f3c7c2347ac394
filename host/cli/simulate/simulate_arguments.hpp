/// @file simulate_arguments.hpp
/// The arguments of `tetwarp simulate`.
#pragma once
#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>

#include <tetwarp/contact.hpp>
#include <tetwarp/simulate.hpp>
#include <tetwarp/warp.hpp>

#include "host/cli/common/picture_options.hpp"
#include "host/cli/job/extra_outputs.hpp"
#include "host/cli/job/output_grid.hpp"

namespace tetwarp::cli {

/// Their syntax is checked; files are not read.
struct SimulateArguments {
  std::string scene_file;
  std::string scene_name;  ///< of a scene that ships with the command, or "list"
  bool print = false;      ///< only print the scene's text
  std::string folder;      ///< for the results
  std::optional<std::int64_t> steps;
  SimulateOptions simulate;
  std::string checkpoint;             ///< file; empty: none
  std::int64_t checkpoint_every = 0;  ///< steps; 0: at the end only
  std::string restart;                ///< file; empty: from the start
  std::string contacts;               ///< file; empty: none
  std::optional<FrictionLaw> law;     ///< instead of the scene's
  std::optional<AdhesionRule> rule;   ///< instead of the scene's
  bool adheres = true;                ///< false: whatever the scene says, nothing adheres

  bool warps = false;
  std::string warped_body;  ///< empty: all that are made of a volume
  bool has_filter = false;  ///< --filter was given
  WarpOptions warp;
  GridChoice grid{"bounds", {}, {}, {}, {}, {}};
  ExtraChoice extra;  ///< arrays beside the warped ones
  int compress = 0;

  bool draws = false;  ///< pictures
  std::string film;    ///< file; empty: none
  PictureOptions pictures;

  std::string report;  ///< file; empty: report.json in the folder
  bool quiet = false;

  /// The scene, for messages.
  const std::string& scene() const { return scene_file.empty() ? scene_name : scene_file; }
};

/// Declares every option and binds it to `arguments`, which must outlive `app`.
void declare_simulate_options(CLI::App& app, SimulateArguments& arguments);

/// Throws CLI::ValidationError for options of warped volumes where no volume is warped.
void check_warping(const CLI::App& app, const SimulateArguments& arguments);

/// Throws CLI::ValidationError when options are missing or contradict each other.
void check_complete(const SimulateArguments& arguments);

}  // namespace tetwarp::cli
