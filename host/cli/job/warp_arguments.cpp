/// @file warp_arguments.cpp
/// The options of tetwarp warp.
#include "host/cli/job/warp_arguments.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "host/cli/common/axes_option.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/ten_nodes_option.hpp"
#include "host/cli/job/label_rule_option.hpp"

namespace tetwarp::cli {
namespace {
const Choices<Quantity> vector_laws{
    {name_of(Quantity::vector), Quantity::vector},
    {name_of(Quantity::covariant_vector), Quantity::covariant_vector},
    {name_of(Quantity::contravariant_vector), Quantity::contravariant_vector}};
const Choices<Quantity> tensor_laws{
    {name_of(Quantity::tensor), Quantity::tensor},
    {name_of(Quantity::principal_tensor), Quantity::principal_tensor}};

/// Words of --outputs with their indices in the table.
Choices<std::size_t> extra_choices() {
  Choices<std::size_t> choices;
  for (const ExtraOutput& extra : extra_outputs) choices.emplace_back(extra.word, choices.size());
  return choices;
}

/// Bytes from "512M", "4G" or "1.5T" in powers of 1024, or from plain digits.
double parse_bytes(const std::string& text) {
  const std::string units = "KMGT";
  std::size_t used = 0;
  double bytes = 0;
  try {
    bytes = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  const std::size_t unit = used + 1 == text.size() ? units.find(text[used]) : std::string::npos;
  if (used == 0 || (used < text.size() && unit == std::string::npos) || !(bytes > 0) ||
      !std::isfinite(bytes)) {
    throw std::invalid_argument("'" + text + "' is not a size such as 512M or 4G");
  }
  return used < text.size() ? std::ldexp(bytes, 10 * static_cast<int>(unit + 1)) : bytes;
}

/// Declares an option with a parser of its text, whose std::invalid_argument is a usage error.
template <class T, class Parse>
void add_parsed(CLI::App& app,
                const std::string& option,
                T& target,
                Parse parse,
                const std::string& type_name,
                const std::string& description) {
  app.add_option_function<std::string>(
         option,
         [&target, option, parse](const std::string& text) {
           try {
             target = parse(text);
           } catch (const std::invalid_argument& error) {
             throw CLI::ValidationError(option, error.what());
           }
         },
         description)
      ->type_name(type_name);
}

/// Declares an option of a fixed count of numbers, separated by commas or spaces.
template <class Numbers>
void add_numbers(CLI::App& app,
                 const std::string& option,
                 std::optional<Numbers>& target,
                 const std::string& type_name,
                 const std::string& description) {
  app.add_option_function<Numbers>(
         option, [&target](const Numbers& numbers) { target = numbers; }, description)
      ->delimiter(',')
      ->type_name(type_name);
}

/// Declares a repeatable option NAME[=LAW]: the first law is the default.
void add_quantities(CLI::App& app,
                    const std::string& option,
                    std::map<std::string, Quantity>& quantities,
                    const Choices<Quantity>& laws,
                    const std::string& description) {
  app.add_option_function<std::vector<std::string>>(
         option,
         [&quantities, option, laws](const std::vector<std::string>& texts) {
           for (const std::string& text : texts) {
             const std::size_t split = std::min(text.rfind('='), text.size());
             const bool is_given = split < text.size();
             quantities[text.substr(0, split)] =
                 is_given ? meaning_of(option, text.substr(split + 1), laws) : laws.front().second;
           }
         },
         description)
      ->allow_extra_args(false)
      ->type_name("NAME[=" + CLI::detail::join(words_of(laws), "|") + "]");
}

/// Sets Outside and its distance from a word, with falloff "falloff:DISTANCE".
void set_outside(const std::string& text, WarpOptions& warp) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  warp.outside = meaning_of("--outside", text.substr(0, colon), choices_of<Outside>());
  const bool has_distance = colon < text.size();
  if (has_distance != (warp.outside == Outside::falloff)) {
    throw CLI::ValidationError("--outside", has_distance
                                                ? "only falloff takes a distance"
                                                : "falloff takes a distance, as in falloff:20");
  }
  if (!has_distance) return;
  const std::string distance = text.substr(colon + 1);
  if (!CLI::detail::lexical_cast(distance, warp.falloff) || !std::isfinite(warp.falloff) ||
      !(warp.falloff > 0)) {
    throw CLI::ValidationError("--outside", "'" + distance + "' is not a distance above 0");
  }
}
}  // namespace

void declare_grid_options(CLI::App& app, GridChoice& grid) {
  app.add_option("--grid", grid.base,
                 "output grid: the source's, the deformed mesh's box on it, or a volume's [" +
                     grid.base + "]")
      ->type_name("same|bounds|FILE");
  app.add_option("--like", grid.base, "as --grid FILE: onto the grid of a volume")
      ->type_name("FILE")
      ->excludes("--grid");
  add_series(app, grid.series, "--like-series");
  add_numbers(app, "--dims", grid.dims, "NI,NJ,NK",
              "voxels of the output grid; alone it keeps the base's box [--spacing]");
  add_numbers(app, "--origin", grid.origin, "X,Y,Z", "center of its first voxel");
  add_numbers(app, "--spacing", grid.spacing, "X,Y,Z",
              "distance of its voxel centers; alone it keeps the base's box [--dims]");
  add_numbers(app, "--direction", grid.direction, "D1,...,D9", "its axes as columns, row by row");
}

void declare_sampling_options(CLI::App& app, WarpOptions& warp) {
  add_choice(app, "--filter", warp.filter, choices_of<Filter>(),
             "interpolation between voxel centers [linear]");
  declare_label_rule(app, warp);
  add_choice(app, "--overshoot", warp.overshoot, choices_of<Overshoot>(),
             "interpolated values beyond the source's range: cubic, bspline, lanczos [keep]");
  app.add_flag("--antialias", warp.antialias, "average samples where tetrahedra shrink the source");
  add_choice(app, "--intensity", warp.intensity, choices_of<Intensity>(),
             "samples are values, densities, or densities with totals preserved [value]");
}

void declare_outside_options(CLI::App& app, WarpOptions& warp) {
  app.add_option_function<std::string>(
         "--outside", [&warp](const std::string& text) { set_outside(text, warp); },
         "voxels outside the mesh: --background, the source, the source moved as the nearest point "
         "of the mesh, or so with displacements that fall to 0 over a distance [background]")
      ->type_name("background|identity|nearest|falloff:DISTANCE");
  app.add_option("--background", warp.background, "value of uncovered voxels [0]")
      ->check(representable_number())
      ->type_name("V");
}

void declare_extra_outputs(CLI::App& app, ExtraChoice& extra) {
  add_word_list(
      app, "--outputs", extra_choices(), [&extra](std::size_t output) { extra.insert(output); },
      "extra arrays tetwarp_mask and so on: covered or not; owning cell; rest minus output "
      "position; det F; F = d deformed / d rest by rows; Green-Lagrange strain XX YY ZZ XY YZ XZ; "
      "deformed minus rest position of the source's voxels; 0 (tet: -1) in uncovered voxels");
}

namespace {
void declare_files(CLI::App& app, WarpArguments& arguments) {
  app.add_option("FILES", arguments.files,
                 "one or more volumes (VTKHDF, NIfTI, NRRD, MetaImage, .mgz, .vti, a folder of "
                 "DICOM images), then the mesh that "
                 "warps them (VTKHDF, .msh, .vtu, .vtk, .pvd, .vtm, .exo, 'step_*.vtu'), or one "
                 "volume and a displacement field or a transform of ITK (.tfm, .txt, .mat, .h5)")
      ->type_name("");
  app.add_option(
         "-o,--output", arguments.output,
         "file to write, .vtkhdf, .nii.gz, .nrrd, .mha, .mhd, .mgz or .vti; for several volumes a "
         "folder")
      ->type_name("OUT");
  app.add_option("--array", arguments.arrays, "array to warp, repeatable [every array]")
      ->allow_extra_args(false)
      ->type_name("NAME");
  app.add_option("--source-step", arguments.source_step,
                 "step of a volume file with several steps [0; by a mesh of one step all]")
      ->check(at_least(0))
      ->type_name("N");
  add_series(app, arguments.series);
  app.add_flag("--pair", arguments.pair, "warp step n of the volume by step n of the mesh");
  add_parsed(
      app, "--steps", arguments.steps, [](const std::string& text) { return StepSelection(text); },
      "LIST",
      "steps of the mesh: numbers and half-open slices, e.g. 0:10:2 or -1 [all]; of a displacement "
      "field the one");
  app.add_option("--displacement", arguments.mesh.import.displacement,
                 "of a mesh in .msh, .vtu or .vtk: point array (Gmsh: node data) that deforms it "
                 "[displacement]")
      ->type_name("NAME");
  add_axes(
      app, arguments.axes,
      "axes of meshes in .msh, .vtu and .vtk and of vectors and tensors in NIfTI, NRRD and "
      "MetaImage files; lps is turned to ras [ras; of a displacement field what its intent tells]");
  app.add_option_function<std::string>(
         "--fsl",
         [&arguments](const std::string& word) {
           arguments.fsl = meaning_of("--fsl", word, choices_of<FslWarp>());
         },
         "the last file is a warp field of FSL, and what its numbers are [told by its intent and "
         "its numbers]")
      ->type_name("relative|absolute");
  add_ten_nodes(app, arguments.mesh.import.keeps_curved);
  app.add_option("--rest", arguments.mesh.rest_file, "mesh file that holds the rest positions")
      ->type_name("FILE");
  app.add_option(
         "--rest-step", arguments.mesh.rest_step,
         "step that holds the rest positions of moving points, also of --rest FILE [0; of FILE "
         "none]")
      ->check(at_least(0))
      ->type_name("N");
}

void declare_grid(CLI::App& app, WarpArguments& arguments) {
  declare_grid_options(app, arguments.grid);
  add_parsed(app, "--roi", arguments.warp.region, parse_region, "I0:I1,J0:J1,K0:K1",
             "part of the output grid to compute, half-open");
}

void declare_result(CLI::App& app, WarpArguments& arguments) {
  WarpOptions& warp = arguments.warp;
  declare_sampling_options(app, warp);
  add_quantities(app, "--vectors", arguments.quantities, vector_laws,
                 "array of 3 components to reorient, repeatable [rotate]");
  add_quantities(app, "--tensors", arguments.quantities, tensor_laws,
                 "array of 6 components XX YY ZZ XY YZ XZ to reorient, repeatable [finite-strain]");
  declare_outside_options(app, warp);
  declare_extra_outputs(app, arguments.extra);
  app.add_flag("--temporal", arguments.temporal, "write all steps to one file");
  app.add_option("--compress", arguments.compress, "deflate level, 0 for none [0; of .nii.gz 6]")
      ->check(between(0, 9))
      ->type_name("L");
  app.add_flag("--resume", arguments.resume, "keep outputs that are complete and up to date");
}

void declare_skips(CLI::App& app, SkipOptions& skip) {
  using Switch = std::vector<bool SkipOptions::*>;
  const Choices<Switch> skips{
      {"rejected-cells", {&SkipOptions::rejected_cells}},
      {"accepted-cells", {&SkipOptions::accepted_cells}},
      {"copied-voxels", {&SkipOptions::copied_voxels}},
      {"unchanged-steps", {&SkipOptions::unchanged_steps}},
      {"unchanged-tets", {&SkipOptions::unchanged_tets}},
      {"constant-cells", {&SkipOptions::constant_cells}},
      {"interior-cells", {&SkipOptions::interior_cells}},
      {"background-chunks", {&SkipOptions::background_chunks}},
      {"grid-point-masks", {&SkipOptions::grid_point_masks}},
      {"all",
       {&SkipOptions::rejected_cells, &SkipOptions::accepted_cells, &SkipOptions::copied_voxels,
        &SkipOptions::unchanged_steps, &SkipOptions::unchanged_tets, &SkipOptions::constant_cells,
        &SkipOptions::interior_cells, &SkipOptions::background_chunks}}};
  add_word_list(
      app, "--no-skip", skips,
      [&skip](const Switch& members) {
        for (bool SkipOptions::*member : members) skip.*member = !(SkipOptions{}.*member);
      },
      "disable optimizations, none of which changes the result; grid-point-masks, not part of all, "
      "rejects and accepts cells by bit masks as Gascon et al. do");
}

void declare_running(CLI::App& app, WarpArguments& arguments) {
  WarpOptions& warp = arguments.warp;
  add_choice(app, "--backend", warp.backend, choices_of<Backend>(), "where to compute [auto]");
  add_device(app, warp.device);
  add_threads(app, warp.threads, "threads of the cpu back end, 0 for all cores [0]");
  declare_skips(app, warp.expert.skip);
  add_parsed(app, "--memory", arguments.memory, parse_bytes, "LIMIT",
             "memory limit, e.g. 4G or 512M; larger volumes are computed in blocks");
  app.add_flag("--dry-run", arguments.dry_run,
               "print the plan and the memory it needs; compute nothing");
  app.add_flag("--strict", arguments.strict,
               "treat warnings as errors, before the output that they concern gets its name");
  app.add_flag("--count-folded", warp.count_folded, "count voxels inside several tetrahedra");
  app.add_option("--report", arguments.report, "write timings and counts as JSON")
      ->type_name("FILE");
  add_quiet(app, arguments.quiet);
  app.add_flag("--provenance", arguments.provenance,
               "write OUT.json beside each output OUT: version, options, and inputs with their "
               "SHA-256");
  app.add_option("--batch", arguments.batch,
                 "run the jobs of a JSON or CSV file; other options are their defaults")
      ->type_name("FILE");
  app.add_option("--jobs", arguments.jobs,
                 "jobs of a batch at a time, each a process, as far as memory holds them [1]")
      ->check(between(1, max_threads))
      ->type_name("N");
}
}  // namespace

std::vector<std::string> WarpArguments::inputs() const {
  std::vector<std::string> inputs = files;
  if (mesh.rest_file) inputs.push_back(*mesh.rest_file);
  if (grid.has_file()) inputs.push_back(grid.base);
  return inputs;
}

void declare_warp_options(CLI::App& app, WarpArguments& arguments) {
  declare_files(app, arguments);
  declare_grid(app, arguments);
  declare_result(app, arguments);
  declare_running(app, arguments);
}

void check_sampling(const WarpOptions& warp) {
  if (warp.antialias && (warp.filter == Filter::nearest || warp.filter == Filter::labels)) {
    throw CLI::ValidationError(
        "--antialias", "cannot average samples with nearest and labels; use another --filter");
  }
  check_label_rule(warp);
  if (warp.intensity == Intensity::conservative && warp.filter != Filter::linear) {
    throw CLI::ValidationError("--filter", "--intensity conservative uses none; leave it out");
  }
  if (warp.intensity == Intensity::conservative && warp.outside != Outside::background) {
    throw CLI::ValidationError(
        "--outside", "--intensity conservative keeps the total of the mesh alone; leave it out");
  }
  if (warp.intensity == Intensity::density && extends(warp.outside)) {
    throw CLI::ValidationError("--outside",
                               "nearest and falloff are for values, not for --intensity density");
  }
}

void check_complete(const WarpArguments& arguments) {
  check_sampling(arguments.warp);
  if (arguments.pair && arguments.source_step) {
    throw CLI::ValidationError("--pair", "takes all steps of the volume; leave out --source-step");
  }
  if (arguments.jobs > 1 && arguments.batch.empty()) {
    throw CLI::ValidationError("--jobs", "is of a --batch; --threads divides one warp");
  }
  if (!arguments.batch.empty()) {
    if (!arguments.files.empty() || !arguments.output.empty()) {
      throw CLI::ValidationError("--batch",
                                 "name volumes, mesh and output in the jobs of the file instead");
    }
    return;
  }
  if (arguments.files.size() < 2) {
    throw CLI::ValidationError("VOLUME... MESH", "one or more volumes and a mesh are needed");
  }
  if (arguments.output.empty()) throw CLI::ValidationError("-o OUT", "an output is needed");
}

std::vector<std::pair<std::string, std::vector<std::string>>> given_options(const CLI::App& app) {
  std::vector<std::pair<std::string, std::vector<std::string>>> given;
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() > 0 && !option->get_lnames().empty()) {
      given.emplace_back(option->get_lnames().front(), option->results());
    }
  }
  return given;
}

WarpArguments parse_warp_arguments(std::vector<std::string> words) {
  WarpArguments arguments;
  CLI::App app;
  declare_warp_options(app, arguments);
  std::reverse(words.begin(), words.end());  // CLI11 expects the last word first
  app.parse(std::move(words));
  arguments.given = given_options(app);
  check_complete(arguments);
  check_device(app, arguments.warp.backend);
  return arguments;
}

}  // namespace tetwarp::cli
