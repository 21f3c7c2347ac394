/// @file simulate_run.cpp
/// Reads a scene, takes its steps and writes the results.
#include "host/cli/simulate/simulate_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <new>
#include <stdexcept>
#include <string_view>
#include <tetwarp/error.hpp>
#include <tetwarp/scene_io.hpp>
#include <utility>
#include <vector>

#include "host/cli/common/file_checks.hpp"
#include "host/cli/common/interrupt.hpp"
#include "io/files/finished_file.hpp"

namespace tetwarp::cli {
namespace fs = std::filesystem;
namespace {
constexpr double flush_interval = 0.5;      // least time between writes of results [s]
constexpr double most_flush_share = 0.05;   // share of the time of a run for such writes
constexpr double last_picture_seconds = 1;  // time for which a film shows its last picture [s]

/// @param files  out: the files that the scene names
Scene load(const SimulateArguments& arguments, std::vector<std::string>& files) {
  if (!arguments.scene_name.empty()) {
    return parse_scene(scene_text(arguments.scene_name), arguments.scene_name);
  }
  return read_scene(arguments.scene_file, &files);
}

/// Puts the contact options in place of what the scene says.
void choose_contact(const SimulateArguments& arguments, Scene& scene) {
  if (arguments.law) scene.solver.pyramid = *arguments.law == FrictionLaw::pyramid;
  if (arguments.rule) scene.solver.restrictive = *arguments.rule == AdhesionRule::restrictive;
  if (arguments.adheres) return;
  scene.contact.material.adhesion.reset();
  for (ContactPairMaterial& pair : scene.contact.pairs) pair.adhesion.reset();
  for (Body& body : scene.bodies) {
    if (body.contact) body.contact->adhesion.reset();
  }
  for (Obstacle& obstacle : scene.obstacles) {
    if (obstacle.contact) obstacle.contact->adhesion.reset();
  }
}

/// Files that a run reads, but those that the scene names and the checkpoint.
std::vector<std::string> files_read(const SimulateArguments& arguments) {
  std::vector<std::string> files;
  if (!arguments.scene_file.empty()) files.push_back(arguments.scene_file);
  if (arguments.pictures.casts_by_file()) files.push_back(arguments.pictures.cast);
  if (arguments.grid.has_file()) files.push_back(arguments.grid.base);
  return files;
}

/// Checks the names of all files before anything is computed. The checkpoint that a run continues
/// from may be replaced by its own.
void check_files(const SimulateArguments& arguments) {
  std::vector<std::string> inputs = files_read(arguments);
  check_new_folder(arguments.folder, arguments.folder);
  if (!arguments.checkpoint.empty()) check_output_file(arguments.checkpoint, inputs);
  if (!arguments.restart.empty()) inputs.push_back(arguments.restart);
  for (const std::string& file : {arguments.film, arguments.report, arguments.contacts}) {
    if (!file.empty()) check_output_file(file, inputs);
  }
}

/// True for the names of the files that a run writes of a body.
bool is_of_body(const std::string& name, const std::string& body) {
  if (!name.starts_with(body + ".")) return false;
  const std::string rest = name.substr(body.size());
  return rest == ".vtkhdf" || rest == ".surface.vtkhdf" || rest == ".look.vtkhdf" ||
         (rest.starts_with(".warped_") && rest.ends_with(".vtkhdf"));
}

/// No two results are written to one file, and none to a file that is read.
void check_results(const SimulateArguments& arguments,
                   const Scene& scene,
                   const std::vector<std::string>& inputs) {
  std::map<std::string, std::string> taken;  // what each path is
  const auto add = [&](const fs::path& path, const std::string& what, const char* option) {
    const auto [place, is_new] = taken.try_emplace(canonical_path(path.string()), what);
    if (is_new) return;
    throw IoError(path.string(), "", "is " + place->second + "; choose another name for " + option);
  };
  const fs::path folder = arguments.folder;
  add(folder / "series.h5", "the series of the run", "-o");
  for (const Body& body : scene.bodies) {
    for (const char* const end : {".vtkhdf", ".surface.vtkhdf", ".look.vtkhdf"}) {
      taken.emplace(canonical_path(folder / (body.name + end)),
                    "the file of body '" + body.name + "'");
    }
  }
  if (arguments.report.empty()) add(folder / "report.json", "the report of the run", "-o");
  const auto add_option = [&](const std::string& path, const char* option) {
    if (!path.empty()) add(path, std::string("the file of ") + option, option);
  };
  add_option(arguments.report, "--report");
  add_option(arguments.checkpoint, "--checkpoint");
  add_option(arguments.contacts, "--contacts");
  add_option(arguments.film, "--film");
  for (const std::string& input : inputs) {
    const fs::path path = canonical_path(input);
    const bool is_in_folder = path.parent_path() == canonical_path(folder.string());
    for (const Body& body : scene.bodies) {
      if (!is_in_folder || !is_of_body(path.filename().string(), body.name)) continue;
      throw IoError(input, "",
                    "is an input, and body '" + body.name +
                        "' would be written to it; choose another folder for -o");
    }
    if (const auto found = taken.find(path.string()); found != taken.end()) {
      throw IoError(input, "",
                    "is an input and " + found->second + "; choose another name for the latter");
    }
  }
}

/// Adhesion that never breaks, which a scene may say without a wish for it.
void add_adhesion_warnings(const std::string& file, const Scene& scene, Warnings& warnings) {
  const auto check = [&](const std::optional<AdhesionMaterial>& adhesion,
                         const std::string& place) {
    if (!adhesion || adhesion->energy != 0 || adhesion->viscosity != 0) return;
    warnings.push_back(file + ": " + place +
                       ": with energy 0 and viscosity 0 bonds never weaken and never break; bonds "
                       "with a viscosity above 0 do");
  };
  check(scene.contact.material.adhesion, "contact.adhesion");
  for (std::size_t p = 0; p < scene.contact.pairs.size(); ++p) {
    check(scene.contact.pairs[p].adhesion, "contact.pairs[" + std::to_string(p) + "].adhesion");
  }
  for (const Body& body : scene.bodies) {
    if (body.contact) check(body.contact->adhesion, body.name + ".contact.adhesion");
  }
  for (const Obstacle& obstacle : scene.obstacles) {
    if (obstacle.contact) check(obstacle.contact->adhesion, obstacle.name + ".contact.adhesion");
  }
}

std::vector<std::byte> bytes_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::error_code error;
  if (!file || fs::is_directory(path, error)) {
    throw IoError(path, "", "cannot be opened; name a file that --checkpoint wrote");
  }
  const std::vector<char> chars{std::istreambuf_iterator<char>(file), {}};
  std::vector<std::byte> bytes(chars.size());
  std::ranges::transform(chars, bytes.begin(), [](char c) { return static_cast<std::byte>(c); });
  return bytes;
}
}  // namespace

SimulateRun::SimulateRun(const SimulateArguments& arguments) : arguments_(arguments) {
  check_files(arguments);
  const Stopwatch reading;
  std::vector<std::string> files;
  Scene scene = load(arguments, files);
  const std::vector<std::string> others = files_read(arguments);
  files.insert(files.end(), others.begin(), others.end());
  choose_contact(arguments, scene);
  result_.read_seconds = reading.seconds();
  check_results(arguments, scene, files);
  last_step_ = arguments.steps.value_or(scene.step_count());
  frames_.emplace(scene.output, scene.time_step, last_step_);
  SimulateOptions options = arguments.simulate;
  options.progress = [](const StepProgress&) { return !is_interrupted(); };
  const Stopwatch setup;
  try {
    simulator_ = std::make_unique<Simulator>(std::move(scene), options);
  } catch (const std::invalid_argument& error) {
    throw IoError(arguments.scene(), "", error.what());
  }
  result_.setup_seconds = setup.seconds();
  if (!arguments.restart.empty()) restore();
  series_.emplace(simulator_->scene());
  if (arguments.warps || !arguments.pictures.cast.empty()) warps_.emplace(*simulator_, arguments);
  if (arguments.draws || !arguments.film.empty()) pictures_.emplace(*simulator_, arguments);
}

void SimulateRun::restore() {
  try {
    simulator_->restore(bytes_of_file(arguments_.restart));
  } catch (const std::invalid_argument& error) {
    throw IoError(arguments_.restart, "", error.what());
  }
  result_.first_step = simulator_->step_index();
  if (result_.first_step > last_step_) {
    throw IoError(arguments_.restart, "",
                  fmt::format("is the state after step {}, beyond the last step {}; raise --steps "
                              "or the scene's duration",
                              result_.first_step, last_step_));
  }
}

void SimulateRun::open_files() {
  fs::create_directories(arguments_.folder);
  if (pictures_) pictures_->begin();
  const std::string series_path = (fs::path(arguments_.folder) / "series.h5").string();
  const std::int64_t step = simulator_->step_index();
  next_frame_ = frames_->count_through(step);
  std::int64_t kept_frames = -1;
  std::error_code error;
  if (!arguments_.restart.empty() && fs::exists(series_path, error)) {
    series_file_.emplace(SeriesWriter::reopen(series_path, series_->columns(), step));
    kept_frames = next_frame_ - frames_->count_through(series_file_->first_step() - 1);
  } else {
    series_file_.emplace(series_path, series_->columns(), step);
  }
  bodies_.emplace(*simulator_, arguments_.folder, kept_frames);
  result_.outputs = bodies_->paths();
  result_.outputs.push_back(series_path);
  if (!arguments_.contacts.empty()) {
    contacts_.emplace(arguments_.contacts, kept_frames);
    result_.outputs.push_back(arguments_.contacts);
  }
  if (kept_frames >= 0) {
    const SignalHold until_complete;
    series_file_->drop_later();
    bodies_->drop_later();
    if (contacts_) contacts_->drop_later();
    return;
  }
  write_row();
  if (frames_->step_of(next_frame_ - 1) == step) write_frame(next_frame_ - 1);
  flush();
}

void SimulateRun::write_row() {
  series_file_->append(series_->row_of(simulator_->record()));
  has_unwritten_ = true;
}

/// Results stay in memory for a while: opening and closing all files for every frame would take as
/// long as the steps between frames.
void SimulateRun::flush_if_due() {
  const double interval = std::max(flush_interval, flush_seconds_ / most_flush_share);
  if (since_flush_.seconds() >= interval) flush();
}

void SimulateRun::flush() {
  if (!has_unwritten_) return;
  const Stopwatch writing;
  if (!until_complete_) until_complete_.emplace();
  series_file_->flush();
  bodies_->flush();
  has_unwritten_ = false;
  since_flush_ = {};
  flush_seconds_ = writing.seconds();
  result_.write_seconds += flush_seconds_;
  // After a signal the process is not to end here: finish() follows and completes the files.
  if (!is_interrupted()) until_complete_.reset();
}

double SimulateRun::frame_seconds(std::int64_t frame) const {
  if (frame + 1 >= frames_->count()) return last_picture_seconds;
  return static_cast<double>(frames_->step_of(frame + 1) - frames_->step_of(frame)) *
         simulator_->scene().time_step;
}

void SimulateRun::write_frame(std::int64_t frame) {
  const Stopwatch writing;
  {
    const SignalHold until_complete;
    bodies_->append();
    if (contacts_) contacts_->append(*simulator_);
  }
  result_.write_seconds += writing.seconds();
  flush_if_due();  // warps and pictures may take long
  if (warps_) warps_->write_frame(frame);
  if (pictures_) {
    pictures_->draw_frame(frame, frame_seconds(frame),
                          warps_ ? warps_->warped() : std::vector<WarpedBody>{});
  }
  ++result_.frames;
}

/// Results are flushed first: a run that continues from the checkpoint appends to them.
void SimulateRun::write_checkpoint() {
  flush();
  const Stopwatch writing;
  const std::vector<std::byte> bytes = simulator_->checkpoint();
  write_finished_file(arguments_.checkpoint,
                      {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  result_.write_seconds += writing.seconds();
}

/// @returns false if it failed; then all is as before, and the result has the error
bool SimulateRun::take_step() {
  const Stopwatch stepping;
  try {
    if (!simulator_->step()) throw Cancelled();
  } catch (const Cancelled&) {
    throw;
  } catch (const std::bad_alloc&) {
    result_.error = fmt::format("step {}: out of memory; use fewer or coarser bodies",
                                simulator_->step_index());
  } catch (const CudaError& error) {
    result_.error = fmt::format("step {}: {}", simulator_->step_index(), error.what());
  } catch (const std::exception& error) {
    result_.error = error.what();
  }
  result_.step_seconds += stepping.seconds();
  return result_.error.empty();
}

void SimulateRun::take_steps(ProgressBar& bar) {
  while (simulator_->step_index() < last_step_) {
    stop_if_interrupted();
    if (!take_step()) return;
    const std::int64_t step = simulator_->step_index();
    if (!simulator_->record().converged) ++result_.unconverged_steps;
    if (simulator_->record().out_of_time) ++result_.late_steps;
    write_row();
    if (next_frame_ < frames_->count() && frames_->step_of(next_frame_) == step) {
      write_frame(next_frame_++);
    }
    flush_if_due();
    if (arguments_.checkpoint_every > 0 && step % arguments_.checkpoint_every == 0) {
      write_checkpoint();
    }
    bar.finish_step();
    const double rate = static_cast<double>(step - result_.first_step) / total_.seconds();
    const std::int64_t contacts = simulator_->record().contacts;
    bar.show_note(fmt::format("{:.2f} s, {:.3g} steps/s", simulator_->time(), rate) +
                  (contacts > 0 ? fmt::format(", {} contacts", contacts) : std::string()));
    bar.update(0, 0);
  }
}

const SimulateResult& SimulateRun::run() {
  try {
    open_files();
    ProgressBar bar(!arguments_.quiet, "simulate", static_cast<std::size_t>(last_step_));
    bar.skip_steps(static_cast<std::size_t>(result_.first_step));
    take_steps(bar);
  } catch (const Cancelled&) {
    result_.is_interrupted = true;
  }
  finish();
  if (!result_.error.empty()) throw std::runtime_error(arguments_.scene() + ": " + result_.error);
  return result_;
}

void SimulateRun::finish() {
  flush();
  if (!until_complete_) until_complete_.emplace();
  series_file_.reset();
  if (contacts_) contacts_->close();
  if (!arguments_.checkpoint.empty()) write_checkpoint();
  std::vector<std::string> numbered;  // the files of frames, without the film
  if (pictures_ && result_.frames > 0) {
    numbered = pictures_->paths();
    pictures_->finish();
    result_.outputs.insert(result_.outputs.end(), pictures_->paths().begin(),
                           pictures_->paths().end());
    result_.draw_seconds = pictures_->seconds();
  }
  if (warps_) {
    numbered.insert(numbered.end(), warps_->paths().begin(), warps_->paths().end());
    result_.outputs.insert(result_.outputs.end(), warps_->paths().begin(), warps_->paths().end());
    result_.warp_seconds = warps_->warp_seconds();
    result_.write_seconds += warps_->write_seconds();
  }
  result_.warnings = simulator_->scene().notes;
  add_adhesion_warnings(arguments_.scene(), simulator_->scene(), result_.warnings);
  for (std::string& warning : older_frames(numbered, next_frame_)) {
    result_.warnings.push_back(std::move(warning));
  }
  if (result_.late_steps > 0) {
    result_.warnings.push_back(fmt::format(
        "{}: the solves of {} of {} steps ended by --max-step-seconds (series.h5: out_of_time)",
        arguments_.scene(), result_.late_steps, simulator_->step_index() - result_.first_step));
  }
  if (result_.unconverged_steps > 0) {
    result_.warnings.push_back(fmt::format(
        "{}: {} of {} steps ended above their tolerance (series.h5: converged)", arguments_.scene(),
        result_.unconverged_steps, simulator_->step_index() - result_.first_step));
  }
  result_.steps_done = simulator_->step_index();
  result_.total_seconds = total_.seconds();
  const std::string report = arguments_.report.empty()
                                 ? (fs::path(arguments_.folder) / "report.json").string()
                                 : arguments_.report;
  write_finished_file(report, report_json(arguments_, *simulator_, *series_, result_) + "\n");
  until_complete_.reset();
}

}  // namespace tetwarp::cli
