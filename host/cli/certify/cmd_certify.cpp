/// @file cmd_certify.cpp
/// The subcommand certify.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <tetwarp/certify.hpp>
#include <tetwarp/error.hpp>
#include <tetwarp/surface_reader.hpp>
#include <tetwarp/version.hpp>
#include <utility>
#include <vector>

#include "host/base/stopwatch.hpp"
#include "host/cli/common/commands.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/common/json_text.hpp"
#include "host/cli/job/step_selection.hpp"
#include "io/files/finished_file.hpp"

namespace tetwarp::cli {
namespace {
using Json = nlohmann::ordered_json;
constexpr int meets_exit_code = 3;
constexpr int undecided_exit_code = 4;

struct CertifyArguments {
  std::vector<std::string> starts;
  std::vector<std::string> ends;  ///< empty: the files of `starts` have steps
  StepSelection steps;
  CertifyOptions options;
  std::string report;
  bool quiet = false;
};

/// Positions of all surfaces at one state.
using State = std::vector<std::vector<Point3>>;

const char* word_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::free:
      return "free";
    case Verdict::meets:
      return "meets";
    default:
      return "undecided";
  }
}

std::vector<SurfaceReader> opened(const std::vector<std::string>& paths) {
  std::vector<SurfaceReader> surfaces;
  surfaces.reserve(paths.size());
  for (const std::string& path : paths) surfaces.emplace_back(path);
  return surfaces;
}

/// A file of a single state and its partner at the end.
void check_pair(const SurfaceReader& start, const SurfaceReader& end) {
  for (const SurfaceReader* surface : {&start, &end}) {
    if (surface->step_count() == 1) continue;
    throw IoError(surface->path(), "",
                  fmt::format("has {} steps; leave out --to, or give files of one state",
                              surface->step_count()));
  }
  if (start.triangles() == end.triangles()) return;
  throw IoError(end.path(), "",
                "has other triangles than " + start.path() +
                    "; write both states with the same points and triangles");
}

/// The first of the files that have several steps, all equally many.
const SurfaceReader& with_steps(const std::vector<SurfaceReader>& surfaces) {
  const SurfaceReader* first = nullptr;
  for (const SurfaceReader& surface : surfaces) {
    if (surface.step_count() == 1) continue;
    if (first == nullptr) first = &surface;
    if (surface.step_count() == first->step_count()) continue;
    throw IoError(surface.path(), "",
                  fmt::format("has {} steps, but {} has {}; give files of equally many, or of one",
                              surface.step_count(), first->path(), first->step_count()));
  }
  if (first == nullptr) {
    throw IoError(surfaces.front().path(), "",
                  "holds one state, as do all files; give those of the end by --to");
  }
  return *first;
}

/// Files of one state are at rest in all steps.
State state_of(const std::vector<SurfaceReader>& surfaces, std::int64_t step) {
  State state;
  for (const SurfaceReader& surface : surfaces) {
    state.push_back(surface.points(surface.step_count() == 1 ? 0 : step));
  }
  return state;
}

std::vector<MovingSurface> motion_of(const std::vector<SurfaceReader>& surfaces,
                                     State start,
                                     const State& end) {
  std::vector<MovingSurface> moving;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    if (start[s].size() != end[s].size()) {
      throw IoError(surfaces[s].path(), "",
                    fmt::format("has {} points at the start and {} at the end; write both states "
                                "with the same points",
                                start[s].size(), end[s].size()));
    }
    moving.push_back({std::move(start[s]), end[s], surfaces[s].triangles()});
  }
  return moving;
}

Json json_of(const Certificate& found) {
  Json pairs = Json::array();
  for (const CertifiedPair& pair : found.pairs) {
    pairs.push_back({{"surfaces", pair.surfaces},
                     {"triangles", pair.triangles},
                     {"verdict", word_of(pair.verdict)},
                     {"from", pair.from},
                     {"until", pair.until}});
  }
  return {{"verdict", word_of(found.verdict)},
          {"near_pairs", found.near_pairs},
          {"intervals", found.intervals},
          {"pairs", pairs}};
}

/// Certifies motion after motion and keeps what is reported.
class Certification {
 public:
  explicit Certification(const CertifyArguments& arguments) : arguments_(arguments) {}

  /// @param step  names the motion, empty where there is one
  void add(const std::vector<MovingSurface>& moving, const std::string& step, Json entry) {
    const Stopwatch watch;
    const Certificate found = certify(moving, arguments_.options);
    seconds_ += watch.seconds();
    if (found.verdict == Verdict::meets || verdict_ == Verdict::free) verdict_ = found.verdict;
    entry.update(json_of(found));
    steps_.push_back(std::move(entry));
    print_pairs(found, step);
    if (arguments_.quiet) return;
    fmt::print("{}{}, {} near pairs of triangles\n", step, word_of(found.verdict),
               found.near_pairs);
  }

  Verdict verdict() const { return verdict_; }

  Json report() const {
    return {{"version", TETWARP_VERSION},
            {"surfaces", arguments_.starts},
            {"verdict", word_of(verdict_)},
            {"steps", steps_},
            {"timings", {{"certify", seconds_}, {"total", total_.seconds()}}}};
  }

 private:
  /// The first pair of triangles, and how many follow.
  void print_pairs(const Certificate& found, const std::string& step) const {
    if (found.pairs.empty()) return;
    const auto pair = std::ranges::min_element(found.pairs, {}, [](const CertifiedPair& pair) {
      return std::pair(pair.verdict != Verdict::meets, pair.until);
    });
    const auto name = [&](std::size_t side) {
      return fmt::format("triangle {} of {}", pair->triangles[side],
                         arguments_.starts[static_cast<std::size_t>(pair->surfaces[side])]);
    };
    const std::size_t others = found.pairs.size() - 1;
    fmt::print(stderr, "tetwarp: {}{} and {} {} at time {:.12g}{}\n", step, name(0), name(1),
               pair->verdict == Verdict::meets ? "meet" : "may touch", pair->until,
               others == 0 ? "" : fmt::format("; {} further pairs", others));
  }

  const CertifyArguments& arguments_;
  const Stopwatch total_;
  Verdict verdict_ = Verdict::free;
  Json steps_ = Json::array();
  double seconds_ = 0;
};

void certify_two_states(const CertifyArguments& arguments, Certification& certification) {
  const std::vector<SurfaceReader> starts = opened(arguments.starts);
  const std::vector<SurfaceReader> ends = opened(arguments.ends);
  for (std::size_t s = 0; s < starts.size(); ++s) check_pair(starts[s], ends[s]);
  certification.add(motion_of(starts, state_of(starts, 0), state_of(ends, 0)), "", Json::object());
}

void certify_steps(const CertifyArguments& arguments, Certification& certification) {
  const std::vector<SurfaceReader> surfaces = opened(arguments.starts);
  const SurfaceReader& moving = with_steps(surfaces);
  const std::vector<std::int64_t> steps = arguments.steps.of(moving.step_count(), moving.path());
  if (steps.size() < 2) {
    throw std::invalid_argument("--steps: expected two steps at least, a start and an end");
  }
  State start = state_of(surfaces, steps.front());
  for (std::size_t s = 1; s < steps.size(); ++s) {
    State end = state_of(surfaces, steps[s]);
    certification.add(motion_of(surfaces, std::move(start), end),
                      fmt::format("step {} to {}: ", steps[s - 1], steps[s]),
                      {{"from_step", steps[s - 1]}, {"to_step", steps[s]}});
    start = std::move(end);
  }
}

int run_certify(const CertifyArguments& arguments) {
  if (!arguments.report.empty()) {
    std::vector<std::string> inputs = arguments.starts;
    inputs.insert(inputs.end(), arguments.ends.begin(), arguments.ends.end());
    check_output_file(arguments.report, inputs);
  }
  Certification certification(arguments);
  if (arguments.ends.empty()) {
    certify_steps(arguments, certification);
  } else {
    certify_two_states(arguments, certification);
  }
  if (!arguments.report.empty()) {
    write_finished_file(arguments.report, json_text(certification.report(), 2) + "\n");
  }
  switch (certification.verdict()) {
    case Verdict::free:
      return 0;
    case Verdict::meets:
      return meets_exit_code;
    default:
      return undecided_exit_code;
  }
}

void declare_options(CLI::App& command, CertifyArguments& arguments) {
  command
      .add_option("SURFACE", arguments.starts,
                  "triangles: VTKHDF, .stl, .ply, .obj, .vtp, .vtk or .vtu; those of the start, or "
                  "files with steps")
      ->required()
      ->type_name("");
  CLI::Option* const ends =
      command.add_option("--to", arguments.ends, "the same surfaces at the end, in the same order")
          ->type_name("SURFACE...");
  command
      .add_option_function<std::string>(
          "--steps",
          [&arguments](const std::string& text) {
            try {
              arguments.steps = StepSelection(text);
            } catch (const std::invalid_argument& error) {
              throw CLI::ValidationError("--steps", error.what());
            }
          },
          "states of the files: numbers and half-open slices, e.g. 0:10:2; the motion from each to "
          "the next is examined [all]")
      ->excludes(ends)
      ->type_name("LIST");
  command.add_flag_callback(
      "--no-self", [&arguments] { arguments.options.self = false; },
      "leave out pairs of triangles of the same surface");
  command
      .add_option("--max-intervals", arguments.options.most_intervals,
                  "parts of time that are examined for a pair; then it is undecided [16384]")
      ->check(at_least(1))
      ->type_name("N");
  command.add_option("--report", arguments.report, "write verdicts, pairs and times as JSON")
      ->type_name("FILE");
}
}  // namespace

void add_certify_command(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<CertifyArguments>();
  CLI::App* command = add_subcommand(
      app, "certify", "Prove that moving triangle meshes do not intersect, or that they do",
      "SURFACE... [--to SURFACE...] [options]",
      "  tetwarp certify ball_0.stl floor.stl --to ball_1.stl floor.stl\n"
      "  tetwarp certify run/ball.surface.vtkhdf run/box.vtkhdf --report proof.json\n"
      "Exit status: 0 nothing intersects, at no time; 3 something does; 4 undecided: triangles "
      "come nearer than can be told apart; 2 bad usage; 1 any other failure\n");
  declare_options(*command, *arguments);
  add_threads(*command, arguments->options.threads, "threads, 0 for all cores [0]");
  add_quiet(*command, arguments->quiet);
  command->callback([arguments, &run] {
    const std::size_t surfaces = arguments->starts.size(), ends = arguments->ends.size();
    if (ends != 0 && ends != surfaces) {
      throw CLI::ValidationError(
          "--to", fmt::format("expected {} files, one per surface, got {}", surfaces, ends));
    }
    run = [arguments] { return run_certify(*arguments); };
  });
}

}  // namespace tetwarp::cli
