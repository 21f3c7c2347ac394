/// @file warp_arguments.hpp
/// The arguments of `tetwarp warp`, declared once for command line and batch files.
#pragma once
#include <CLI/CLI.hpp>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/transform_file.hpp>
#include <tetwarp/warp.hpp>

#include "host/cli/job/extra_outputs.hpp"
#include "host/cli/job/output_grid.hpp"
#include "host/cli/job/step_selection.hpp"

namespace tetwarp::cli {

/// Their syntax is checked; files are not read.
struct WarpArguments {
  std::vector<std::string> files;           ///< volumes, then the mesh
  std::string output;                       ///< file, or folder for several volumes
  std::vector<std::string> arrays;          ///< empty: every array
  std::optional<std::int64_t> source_step;  ///< of volume files with several steps
  std::string series;                       ///< UID of the DICOM series in a folder
  bool pair = false;                        ///< step n of the mesh warps step n of the volume
  StepSelection steps;
  MeshReadOptions mesh;        ///< without the axes of `import`
  std::optional<Axes> axes;    ///< of files that are not VTKHDF
  std::optional<FslWarp> fsl;  ///< the last file is a warp field of FSL
  GridChoice grid;
  std::map<std::string, Quantity> quantities;  ///< of arrays, by name; others are components
  WarpOptions warp;  ///< without output_grid and quantities, which need the files
  ExtraChoice extra;
  int compress = 0;
  bool temporal = false;
  bool resume = false;
  bool strict = false;   ///< warnings are errors
  double memory = 0;     ///< limit of the process [byte]; 0: the available memory
  bool dry_run = false;  ///< plan only
  bool quiet = false;
  std::string report;
  std::string batch;
  int jobs = 1;             ///< of a batch, processes at a time
  bool provenance = false;  ///< write a file beside each output of what it was made from
  /// Options as given, with their values, in the order of the help.
  std::vector<std::pair<std::string, std::vector<std::string>>> given;

  std::vector<std::string> volumes() const { return {files.begin(), files.end() - 1}; }
  const std::string& mesh_file() const { return files.back(); }
  std::vector<std::string> inputs() const;  ///< all files that are named to be read
  /// How to read the last file if it is a transform.
  TransformReadOptions transform_options() const { return {axes, fsl, files.front(), output}; }
  Quantity quantity_of(const std::string& array) const {
    const auto found = quantities.find(array);
    return found == quantities.end() ? Quantity::components : found->second;
  }
};

/// Declares every option and binds it to `arguments`, which must outlive `app`.
void declare_warp_options(CLI::App& app, WarpArguments& arguments);

/// Declare parts of these options, which `tetwarp simulate` has, too: --grid, --dims, --origin,
/// --spacing and --direction; --filter, --overshoot, --antialias and --intensity; --outside and
/// --background; --outputs.
void declare_grid_options(CLI::App& app, GridChoice& grid);
void declare_sampling_options(CLI::App& app, WarpOptions& warp);
void declare_outside_options(CLI::App& app, WarpOptions& warp);
void declare_extra_outputs(CLI::App& app, ExtraChoice& extra);

/// Throws CLI::ValidationError when filter and antialiasing or intensity contradict each other.
void check_sampling(const WarpOptions& warp);

/// Throws CLI::ValidationError when volumes, mesh or output are missing, are given with --batch, or
/// when options contradict each other.
void check_complete(const WarpArguments& arguments);

/// Options that were given, with their values, without files.
std::vector<std::pair<std::string, std::vector<std::string>>> given_options(const CLI::App& app);

/// Parses words as those of a command line. Throws CLI::ParseError.
WarpArguments parse_warp_arguments(std::vector<std::string> words);

}  // namespace tetwarp::cli
