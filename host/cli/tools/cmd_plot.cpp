/// @file cmd_plot.cpp
/// The subcommand plot.
#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <tetwarp/error.hpp>
#include <utility>
#include <vector>

#include "host/cli/common/commands.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/tools/chart.hpp"
#include "io/files/extension.hpp"
#include "io/files/finished_file.hpp"
#include "io/vtkhdf/series_reader.hpp"

namespace tetwarp::cli {
namespace fs = std::filesystem;
namespace {
struct PlotArguments {
  std::vector<std::string> runs;
  std::string output;
  std::vector<std::string> shown{"contacts", "seconds", "energy", "adhered_area"};
  bool over_time = false;
  bool quiet = false;
};

/// The series of a run: the file itself, or that in the folder.
std::string series_of(const std::string& run) {
  return fs::is_directory(run) ? (fs::path(run) / "series.h5").string() : run;
}

/// The last name of a path.
std::string last_name(const std::string& path) {
  return path.substr(path.rfind('/') + 1);
}

/// " [J]" of a dataset or group of a series; empty: numbers without unit, or of several.
std::string unit_of(const std::string& path) {
  static constexpr std::array<std::pair<std::string_view, const char*>, 9> units{
      {{"energy", "J"},
       {"seconds", "s"},
       {"time", "s"},
       {"adhered_area", "m^2"},
       {"smallest_distance", "m"},
       {"momentum", "kg m/s"},
       {"angular_momentum", "kg m^2/s"},
       {"velocity", "m/s"},
       {"angular_velocity", "rad/s"}}};
  const std::string first = path.substr(0, path.find('/')), last = last_name(path);
  if (last.ends_with("force")) return " [N]";
  for (const auto& [name, unit] : units) {
    if (first == name || last == name) return fmt::format(" [{}]", unit);
  }
  return "";
}

ChartRow read_row(const std::vector<SeriesReader>& readers,
                  const std::vector<std::string>& runs,
                  const std::string& shown) {
  ChartRow row;
  row.title = shown + unit_of(shown);
  const std::vector<std::string> paths = readers.front().paths_of(shown);
  for (std::size_t k = 0; k < readers.size(); ++k) {
    if (readers[k].paths_of(shown) != paths) {
      throw IoError(runs[k], shown,
                    "has other datasets than in " + runs.front() + "; name those that both have");
    }
    std::vector<Curve> curves;
    for (const std::string& path : paths) {
      curves.push_back({last_name(path), readers[k].read(path)});
    }
    row.columns.push_back(std::move(curves));
  }
  return row;
}

/// Where the rows of a series are: at steps, or at times, which have equal distances.
ChartColumn column_of(const SeriesReader& reader,
                      const PlotArguments& arguments,
                      const std::string& run) {
  ChartColumn column{run, static_cast<double>(reader.first_step()), 1};
  if (!arguments.over_time) return column;
  const std::vector<double> times = reader.read("time");
  if (times.empty()) return {run, 0, 1};
  column.first = times.front();
  if (times.size() > 1) {
    column.step = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  }
  return column;
}

int run_plot(const PlotArguments& arguments) {
  if (!has_extension(arguments.output, ".svg")) {
    throw IoError(arguments.output, "", "the name of a chart ends in .svg");
  }
  std::vector<std::string> inputs;
  std::vector<SeriesReader> readers;
  for (const std::string& run : arguments.runs) {
    inputs.push_back(series_of(run));
    readers.emplace_back(inputs.back());
  }
  check_output_file(arguments.output, inputs);
  Chart chart{arguments.over_time ? "time [s]" : "step", {}, {}};
  for (std::size_t k = 0; k < readers.size(); ++k) {
    chart.columns.push_back(column_of(readers[k], arguments, arguments.runs[k]));
  }
  for (const std::string& shown : arguments.shown) {
    chart.rows.push_back(read_row(readers, arguments.runs, shown));
  }
  write_finished_file(arguments.output, draw_chart(chart));
  if (!arguments.quiet) fmt::print("{}\n", arguments.output);
  return 0;
}
}  // namespace

void add_plot_command(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<PlotArguments>();
  CLI::App* command = add_subcommand(
      app, "plot", "Draw numbers of simulations over their steps", "RUN... -o FILE.svg [options]",
      "  tetwarp plot results -o curves.svg\n"
      "  tetwarp plot bonded free -o both.svg --show contacts,energy/adhesion --over-time\n");
  command->add_option("RUN", arguments->runs, "folders of runs, or their files series.h5")
      ->required()
      ->type_name("");
  command->add_option("-o,--output", arguments->output, "chart to write")
      ->required()
      ->type_name("FILE.svg");
  command
      ->add_option("--show", arguments->shown,
                   "datasets and groups of series.h5, one row of plots each "
                   "[contacts,seconds,energy,adhered_area]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NAME,...");
  command->add_flag("--over-time", arguments->over_time,
                    "along the time of the simulation instead of steps");
  add_quiet(*command, arguments->quiet);
  command->callback([arguments, &run] { run = [arguments] { return run_plot(*arguments); }; });
}

}  // namespace tetwarp::cli
