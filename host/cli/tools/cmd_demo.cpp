/// @file cmd_demo.cpp
/// The subcommand demo.
#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <tetwarp/io.hpp>
#include <tetwarp/make.hpp>

#include "host/cli/common/commands.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/tools/displacement.hpp"
#include "host/cli/warp/warp_job.hpp"

namespace tetwarp::cli {
namespace {
namespace fs = std::filesystem;

struct DemoArguments {
  std::string folder = "tetwarp-demo";
  std::array<std::int64_t, 3> dims{256, 160, 122};
  int steps = 8;
  int cells = 6;
  bool quiet = false;
};

struct DemoFiles {
  explicit DemoFiles(const fs::path& folder)
      : volume((folder / "volume.vtkhdf").string()),
        mesh((folder / "mesh.vtkhdf").string()),
        warped((folder / "warped.vtkhdf").string()),
        picture((folder / "before_after.png").string()),
        report((folder / "report.json").string()) {}

  std::string volume;
  std::string mesh;
  std::string warped;
  std::string picture;
  std::string report;
};

void make_inputs(const DemoArguments& arguments, const DemoFiles& files) {
  const Volume volume = make_phantom(arguments.dims);
  write_volumes(files.volume, {&volume});
  const Mesh mesh = make_lattice_mesh(volume, {.cells = arguments.cells, .threshold = {}});
  write_deformed_mesh(files.mesh, mesh, {.kind = Deformation::twist}, arguments.steps);
  if (arguments.quiet) return;
  fmt::print("phantom of {} x {} x {} voxels, {} tetrahedra, {} steps of twisting\n",
             arguments.dims[0], arguments.dims[1], arguments.dims[2], mesh.tets.size(),
             arguments.steps);
}

void draw(const DemoFiles& files, const std::string& last_output) {
  const Volume before = read_volume(files.volume);
  const Volume after = read_volume(last_output);
  write_png(files.picture, render(std::array<const Volume*, 2>{&before, &after}));
}

void print_timings(const Report& report) {
  const auto steps = static_cast<double>(report.steps.size());
  const Timings& sum = report.timings;
  const auto line = [&](const char* stage, double seconds) {
    if (seconds > 0) fmt::print("  {:<9}{:9.2f} ms\n", stage, 1e3 * seconds / steps);
  };
  fmt::print("per step:\n");
  line("read", sum.read);
  line("upload", sum.upload);
  line("setup", sum.setup);
  line("cull", sum.cull);
  line("raster", sum.raster);
  line("download", sum.download);
  line("write", sum.write);
}

int run_demo(const DemoArguments& arguments) {
  if (fs::exists(arguments.folder) && !fs::is_directory(arguments.folder)) {
    throw IoError(arguments.folder, "", "is a file; name a folder");
  }
  check_new_folder(arguments.folder, arguments.folder);
  fs::create_directories(arguments.folder);
  const DemoFiles files(arguments.folder);
  make_inputs(arguments, files);
  WarpArguments warp;
  warp.files = {files.volume, files.mesh};
  warp.output = files.warped;
  warp.report = files.report;
  const JobResult result =
      run_warp_job(warp, {.label = "demo", .shows_progress = !arguments.quiet});
  draw(files, result.outputs.back());
  if (arguments.quiet) return 0;
  fmt::print("{}", summary(result));
  print_timings(result.report);
  fmt::print("look at {}, or open {} and {} in ParaView\n", files.picture, files.mesh,
             result.outputs.front());
  return 0;
}
}  // namespace

void add_demo_command(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<DemoArguments>();
  CLI::App* command =
      add_subcommand(app, "demo", "Warp a built-in phantom and draw it; needs no file",
                     "[-o FOLDER] [options]", "  tetwarp demo -o tetwarp-demo\n");
  command->add_option("-o,--output", arguments->folder, "folder for the files [tetwarp-demo]")
      ->type_name("FOLDER");
  command->add_option("--dims", arguments->dims, "voxels of the phantom [256,160,122]")
      ->delimiter(',')
      ->check(between(8, 4096))
      ->type_name("NI,NJ,NK");
  command->add_option("--steps", arguments->steps, "steps of the twist [8]")
      ->check(between(2, 1000))
      ->type_name("N");
  command->add_option("--cells", arguments->cells, "cubes of the mesh along the longest side [6]")
      ->check(between(1, 100))
      ->type_name("N");
  add_quiet(*command, arguments->quiet);
  command->callback([arguments, &run] { run = [arguments] { return run_demo(*arguments); }; });
}

}  // namespace tetwarp::cli
