/// @file cmd_compose.cpp
/// The subcommand compose.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <tetwarp/io.hpp>
#include <tetwarp/itk_space.hpp>
#include <utility>
#include <vector>

#include "host/cli/common/axes_option.hpp"
#include "host/cli/common/commands.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/common/interrupt.hpp"
#include "host/cli/common/ten_nodes_option.hpp"
#include "host/cli/job/output_files.hpp"
#include "host/cli/job/output_writer.hpp"
#include "host/cli/job/step_selection.hpp"
#include "host/cli/job/warnings.hpp"
#include "host/cli/job/warp_arguments.hpp"
#include "host/cli/warp/transform_chain.hpp"

namespace tetwarp::cli {
namespace {
struct ComposeArguments {
  std::vector<std::string> words;
  std::string output;
  std::string like;
  std::string like_series;
  StepSelection steps;
  MeshReadOptions mesh;
  std::optional<Axes> axes;
  int threads = 0;
  int compress = 0;
  bool quiet = false;
  std::vector<std::string> given;  ///< long names of the options, without dashes
};

/// One link. Of a mesh in VTKHDF the array is 'displacement'; --rest is of meshes without an array.
/// @param world  of the points; see TransformReadOptions
/// @param used   out: names of options that it takes are added
ChainLink read_link(const ComposeArguments& arguments,
                    const std::string& word,
                    const std::optional<Point3>& world,
                    std::set<std::string>& used) {
  const std::string path = ChainLink::path_of(word);
  const FileKind kind = kind_of(path);
  MeshReadOptions options = arguments.mesh;
  if (options.rest_file) options.rest_step.reset();  // of that file
  options.rest_file.reset();
  if (kind == FileKind::mesh) options.import.displacement.reset();
  ChainLink link(word, options, arguments.axes, world);
  if (kind == FileKind::nifti || kind == FileKind::image) used.insert("axes");
  if (link.mesh() || link.step_count() > 1) used.insert("steps");
  if (!link.mesh()) return link;
  used.insert("ten-nodes");
  if (kind != FileKind::mesh) used.insert({"axes", "displacement"});
  const bool takes_rest = arguments.mesh.rest_file && !link.mesh()->header().has_displacement;
  if (takes_rest) {
    options.rest_file = arguments.mesh.rest_file;
    options.rest_step = arguments.mesh.rest_step;
    used.insert("rest");
  }
  if (takes_rest || !arguments.mesh.rest_file) used.insert("rest-step");
  print_mesh_warnings(path, link.mesh()->header(), options);
  return takes_rest ? ChainLink(word, options, arguments.axes, world) : std::move(link);
}

/// All links. Throws std::invalid_argument about an option that none of them takes.
std::vector<ChainLink> read_links(const ComposeArguments& arguments,
                                  const std::optional<Point3>& world) {
  const std::map<std::string, std::string> takers{
      {"steps", "meshes and fields of several steps"},
      {"ten-nodes", "meshes"},
      {"rest-step", "meshes"},
      {"rest", "meshes without the point array of their displacement"},
      {"displacement", "meshes in .msh, .vtu and .vtk"},
      {"axes", "fields in images and meshes in .msh, .vtu and .vtk"}};
  std::vector<ChainLink> links;
  std::set<std::string> used;
  for (const std::string& word : arguments.words) {
    links.push_back(read_link(arguments, word, world, used));
  }
  for (const auto& [option, taker] : takers) {
    if (std::ranges::count(arguments.given, option) == 0 || used.contains(option)) continue;
    throw std::invalid_argument(
        fmt::format("--{} is for {}, and none is joined; leave it out", option, taker));
  }
  return links;
}

/// Those of the meshes and fields with several steps, which must have equally many.
std::vector<std::int64_t> steps_of(const ComposeArguments& arguments,
                                   const std::vector<ChainLink>& links) {
  const ChainLink* first = &links.front();
  for (const ChainLink& link : links) {
    if (link.step_count() == 1) continue;
    if (first->step_count() > 1 && link.step_count() != first->step_count()) {
      throw IoError(link.path(), "",
                    fmt::format("has {} steps, {} has {}; give files of equally many, or of one",
                                link.step_count(), first->path(), first->step_count()));
    }
    if (first->step_count() == 1) first = &link;
  }
  return arguments.steps.of(first->step_count(), first->path());
}

int run_compose(const ComposeArguments& arguments) {
  check_volume_name(arguments.output);
  check_volume(arguments.like, "--like takes the grid of a volume");
  check_series(arguments.like_series, {arguments.like}, "--like-series");
  VolumeReadOptions read;
  read.series = arguments.like_series;
  const VolumeHeader like = read_volume_header(arguments.like, read);
  const Grid& grid = like.grid;
  std::vector<ChainLink> links = read_links(arguments, itk_factor(arguments.like, like));
  const std::vector<std::int64_t> steps = steps_of(arguments, links);
  std::vector<std::string> inputs{arguments.like};
  for (const ChainLink& link : links) inputs.push_back(link.path());
  if (arguments.mesh.rest_file) inputs.push_back(*arguments.mesh.rest_file);
  std::vector<std::string> names;
  const ArrayHeader array{.name = "tetwarp_displacement",
                          .components = 3,
                          .nifti = facts_of_extra(first_facts(like), 3),
                          .is_itk_field = true};
  for (const std::int64_t step : steps) {
    const SplitName name = split_name(arguments.output);
    names.push_back(steps.size() == 1 ? arguments.output
                                      : fmt::format("{}_{:04}{}", name.stem, step, name.extension));
    check_output_file(names.back(), inputs);
    check_output_arrays(names.back(), grid, {array}, {.compress = arguments.compress}, false);
  }
  check_compress(names, arguments.compress);
  const InterruptFlag flag;
  for (std::size_t s = 0; s < steps.size(); ++s) {
    ChainNotes notes;
    for (ChainLink& link : links) link.choose(steps[s]);
    const std::vector<float> field = displacements_of(links, grid, arguments.threads, notes);
    OutputWriter writer(names[s], grid, {array}, {.compress = arguments.compress}, false, 1,
                        ChunkShape::rows);
    writer.write(0, {{0, 0, 0}, grid.dims}, field.data());
    writer.finish();
    for (const std::string& line : notes.lines(grid.voxel_count())) {
      fmt::print(stderr, "tetwarp: {}: {}\n", names[s], line);
    }
    if (has_nifti_name(names[s]) && itk_components(grid) == 2) {
      fmt::print(stderr, "tetwarp: {}: {}\n", names[s], itk_slice_note);
    }
    if (arguments.quiet) continue;
    const bool inverts = std::ranges::any_of(links, &ChainLink::iterates);
    fmt::print(
        "{} transforms on {} x {} x {} voxels{}: {}\n", links.size(), grid.dims[0], grid.dims[1],
        grid.dims[2],
        inverts ? fmt::format(", inverse of fields within {:.2g}", notes.largest_residual) : "",
        names[s]);
  }
  return 0;
}
}  // namespace

void add_compose_command(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<ComposeArguments>();
  CLI::App* command = add_subcommand(
      app, "compose", "Join meshes, displacement fields and affine transforms to one field",
      "A B^-1 C... -o FIELD --like VOLUME [options]",
      "  tetwarp compose mesh.vtkhdf affine.tfm -o field.nii.gz --like fixed.nii.gz --steps -1\n"
      "  tetwarp warp ct.nii.gz field.nii.gz -o warped.nii.gz --like fixed.nii.gz\n"
      "An image warped by the field is the image warped by A, then by the inverse of B, then by "
      "C,\ninterpolated once.\n");
  command
      ->add_option("FILES", arguments->words,
                   "meshes, displacement fields and affine transforms as of tetwarp warp, in the "
                   "order in which they are applied to an image; ^-1 behind a name is its inverse")
      ->required()
      ->type_name("");
  command->add_option("-o,--output", arguments->output, "field to write, .nii.gz or .vtkhdf")
      ->required()
      ->type_name("FIELD");
  command->add_option("--like", arguments->like, "volume whose grid the field gets")
      ->required()
      ->type_name("FILE");
  add_series(*command, arguments->like_series, "--like-series");
  command
      ->add_option_function<std::string>(
          "--steps",
          [arguments](const std::string& text) {
            try {
              arguments->steps = StepSelection(text);
            } catch (const std::invalid_argument& error) {
              throw CLI::ValidationError("--steps", error.what());
            }
          },
          "steps of the meshes and fields: numbers and half-open slices, e.g. 0:10:2 or -1 [all]")
      ->type_name("LIST");
  command
      ->add_option("--displacement", arguments->mesh.import.displacement,
                   "of meshes in .msh, .vtu and .vtk: point array (Gmsh: node data) that deforms "
                   "them [displacement]")
      ->type_name("NAME");
  command
      ->add_option("--rest", arguments->mesh.rest_file,
                   "mesh file that holds the rest positions of meshes without such an array")
      ->type_name("FILE");
  command
      ->add_option(
          "--rest-step", arguments->mesh.rest_step,
          "step that holds the rest positions of moving points, also of --rest FILE [0; of "
          "FILE none]")
      ->check(at_least(0))
      ->type_name("N");
  add_ten_nodes(*command, arguments->mesh.import.keeps_curved);
  add_axes(*command, arguments->axes,
           "axes of meshes in .msh, .vtu and .vtk, and of the components of fields; lps is turned "
           "to ras [ras; of fields what their intent tells]");
  add_threads(*command, arguments->threads, "threads, 0 for all cores [0]");
  command
      ->add_option("--compress", arguments->compress, "deflate level, 0 for none [0; of .nii.gz 6]")
      ->check(between(0, 9))
      ->type_name("L");
  add_quiet(*command, arguments->quiet);
  command->callback([arguments, command, &run] {
    for (const auto& [name, values] : given_options(*command)) arguments->given.push_back(name);
    run = [arguments] { return run_compose(*arguments); };
  });
}

}  // namespace tetwarp::cli
