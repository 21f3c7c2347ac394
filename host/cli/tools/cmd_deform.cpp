/// @file cmd_deform.cpp
/// The subcommand deform.
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <tetwarp/io.hpp>
#include <tetwarp/make.hpp>
#include <vector>

#include "host/cli/common/axes_option.hpp"
#include "host/cli/common/commands.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/job/warnings.hpp"
#include "host/cli/tools/displacement.hpp"
#include "host/cli/tools/mesh_options.hpp"

namespace tetwarp::cli {
namespace {
const Choices<int> axes{{"x", 0}, {"y", 1}, {"z", 2}};

struct DeformArguments {
  std::string input;
  std::string output;
  int steps = 8;
  DeformOptions deform;
  std::optional<Axes> axes;
  bool quiet = false;
};

/// Throws CLI::ValidationError for options that the kind of deformation does not use.
void check_kind_options(const CLI::App& command, Deformation kind) {
  using Kinds = std::set<Deformation>;
  const std::map<std::string, Kinds> users{
      {"--axis", {Deformation::twist, Deformation::bend, Deformation::swim, Deformation::rotate}},
      {"--amount",
       {Deformation::twist, Deformation::bend, Deformation::swim, Deformation::rotate,
        Deformation::random}},
      {"--seed", {Deformation::random}},
      {"--offset", {Deformation::translate}}};
  for (const auto& [option, kinds] : users) {
    if (command.get_option(option)->count() == 0 || kinds.contains(kind)) continue;
    std::vector<std::string> names;
    for (const Deformation user : kinds) names.emplace_back(name_of(user));
    throw CLI::ValidationError(
        option, "is for --kind " + listed(names) + ", not for " + name_of(kind) + "; leave it out");
  }
}

int run_deform(const DeformArguments& arguments) {
  check_mesh(arguments.input, "usage: tetwarp deform MESH -o MESH");
  check_hdf_name(arguments.output);
  check_output_file(arguments.output, {arguments.input});
  MeshReadOptions options;
  options.import.axes = axes_of_mesh(arguments.input, arguments.axes);
  const MeshReader reader(arguments.input, options);
  write_deformed_mesh(arguments.output, reader.mesh(), arguments.deform, arguments.steps);
  print_merged(arguments.input, reader.header().merged);
  std::vector<std::string> left_out = reader.header().not_read;
  if (reader.header().has_displacement) left_out.insert(left_out.begin(), "its own displacement");
  print_left_out(arguments.input, left_out);
  if (arguments.quiet) return 0;
  fmt::print("{} nodes, {} cells, {} steps of {}: {}\n", reader.header().node_count,
             reader.mesh().cell_count(), arguments.steps, name_of(arguments.deform.kind),
             arguments.output);
  return 0;
}
}  // namespace

void add_deform_command(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<DeformArguments>();
  DeformOptions& deform = arguments->deform;
  CLI::App* command = add_subcommand(
      app, "deform", "Give a mesh a procedural displacement, from rest to the full amount",
      "MESH -o MESH [options]",
      "  tetwarp deform mesh.vtkhdf -o moving.vtkhdf --kind twist --steps 8\n"
      "  tetwarp deform skull.msh -o moving.vtkhdf --kind bend --steps 1\n");
  add_mesh_to_mesh(*command, arguments->input, arguments->output);
  add_choice(*command, "--kind", deform.kind, choices_of<Deformation>(),
             "kind of deformation [twist]");
  command
      ->add_option("--steps", arguments->steps,
                   "number of steps, at times 0 to 1; a single one is at time 1 [8]")
      ->check(between(1, 1000000))
      ->type_name("N");
  command
      ->add_option("--amount", deform.amount,
                   "quarter turns of twist, bend and rotate; else share of the mesh's box [1]")
      ->type_name("A");
  add_choice(*command, "--axis", deform.axis, axes, "axis of twist, bend, swim and rotate [z]");
  command->add_option("--seed", deform.seed, "seed of random [1]")
      ->check(at_least(0, std::numeric_limits<std::int64_t>::max()))
      ->type_name("N");
  command->add_option("--offset", deform.offset, "offset of translate, in world units [0,0,0]")
      ->delimiter(',')
      ->type_name("X,Y,Z");
  add_mesh_axes(*command, arguments->axes);
  add_quiet(*command, arguments->quiet);
  command->callback([arguments, command, &run] {
    check_kind_options(*command, arguments->deform.kind);
    if (!std::isfinite(arguments->deform.amount)) {
      throw CLI::ValidationError("--amount", "expected a finite number");
    }
    for (const double offset : arguments->deform.offset) {
      if (!std::isfinite(offset)) {
        throw CLI::ValidationError("--offset", "expected finite numbers");
      }
    }
    run = [arguments] { return run_deform(*arguments); };
  });
}

}  // namespace tetwarp::cli
