/// @file simulate_warp.cpp
/// Warps of the volumes that bodies are made of.
#include "host/cli/simulate/simulate_warp.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>
#include <tetwarp/io.hpp>
#include <utility>
#include <variant>

#include "host/base/extra_outputs.hpp"
#include "host/base/stopwatch.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/interrupt.hpp"

namespace tetwarp::cli {
BodyWarps::BodyWarps(const Simulator& simulator, const SimulateArguments& arguments)
    : simulator_(simulator), arguments_(arguments) {
  const std::vector<Body>& bodies = simulator.scene().bodies;
  const bool casts = !arguments.pictures.cast.empty();
  const std::string option = arguments.warps ? "--warp: " : "--cast: ";
  bool any_is_written = false;
  std::vector<std::string> names;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto* image = std::get_if<ImageGeometry>(&bodies[b].geometry);
    if (image == nullptr || simulator.body(b).mesh.cell_count() == 0) continue;
    const std::string& name = bodies[b].name;
    names.push_back(name);
    const bool is_written =
        arguments.warps && (arguments.warped_body.empty() || arguments.warped_body == name);
    any_is_written |= is_written;
    if (is_written || casts) followers_.push_back({b, is_written, &image->volume, {}, {}});
  }
  if (followers_.empty() || (arguments.warps && !any_is_written)) {
    const std::string found = names.empty() ? "none is" : "those are " + listed(names);
    throw std::invalid_argument(
        arguments.scene() + ": " + option +
        (arguments.warped_body.empty() ? "no body" : "no body '" + arguments.warped_body + "'") +
        " made of a volume; " + found);
  }
  for (Follower& follower : followers_) {
    try {
      prepare(follower);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(bodies[follower.body].name + ": " + option + error.what());
    }
  }
}

WarpOptions BodyWarps::options_of(const Follower& follower) const {
  WarpOptions options = arguments_.warp;
  const Body& body = simulator_.scene().bodies[follower.body];
  const bool holds_labels = body.lookup == TransferLookup::label && !body.transfer.empty();
  if (!arguments_.has_filter && holds_labels) options.filter = Filter::labels;
  options.output_grid = follower.grid;
  options.backend = simulator_.backend();
  options.device = arguments_.simulate.device;
  options.threads = arguments_.simulate.threads;
  return options;
}

void BodyWarps::prepare(Follower& follower) const {
  const Mesh& mesh = simulator_.body(follower.body).mesh;
  const Grid grid = resolve_grid(arguments_.grid, follower.source->grid, {}, mesh,
                                 [&] { return simulator_.node_positions(follower.body); });
  if (follower.warper && grid == follower.grid) return;
  if (arguments_.extra.contains(forward_output) && grid != follower.source->grid) {
    throw std::invalid_argument(
        "--outputs forward is on the volume's own grid; add --grid same, leave out --dims, "
        "--origin, --spacing and --direction");
  }
  follower.grid = grid;
  follower.warper.emplace(*follower.source, mesh, options_of(follower));
}

std::vector<Volume> BodyWarps::extra_volumes(const Follower& follower) const {
  std::vector<Volume> volumes;
  if (!follower.is_written) return volumes;
  for (const std::size_t e : arguments_.extra) {
    const ExtraOutput& output = extra_outputs[e];
    volumes.push_back(make_volume(follower.grid, output.type, output.components, output.array()));
  }
  return volumes;
}

void BodyWarps::write_frame(std::int64_t frame) {
  const bool casts = !arguments_.pictures.cast.empty();
  warped_.resize(casts ? followers_.size() : 0);
  for (std::size_t f = 0; f < followers_.size(); ++f) {
    Follower& follower = followers_[f];
    const Stopwatch warping;
    prepare(follower);
    const VolumeView source(*follower.source);
    Volume warped =
        make_volume(follower.grid, source.type, source.components, follower.source->name);
    std::vector<Volume> extra = extra_volumes(follower);
    void* const samples = warped.data.data();
    WarpTarget target{.volumes = {&samples, 1}};
    auto array = extra.begin();
    for (const std::size_t e : arguments_.extra) {
      if (array != extra.end()) extra_outputs[e].set(target, (array++)->data.data());
    }
    follower.warper->step(simulator_.positions(follower.body), target,
                          [](double) { return !is_interrupted(); });
    warp_seconds_ += warping.seconds();
    if (follower.is_written) write(follower, warped, extra, frame);
    if (casts) warped_[f] = {follower.body, follower.source, std::move(warped)};
  }
}

void BodyWarps::write(const Follower& follower,
                      const Volume& warped,
                      const std::vector<Volume>& extra,
                      std::int64_t frame) {
  const Stopwatch writing;
  const std::string name = simulator_.scene().bodies[follower.body].name;
  const std::filesystem::path path =
      std::filesystem::path(arguments_.folder) / fmt::format("{}.warped_{:04}.vtkhdf", name, frame);
  std::vector<const Volume*> volumes{&warped};
  for (const Volume& volume : extra) volumes.push_back(&volume);
  write_volumes(path.string(), volumes,
                {.compress = arguments_.compress, .background = arguments_.warp.background});
  paths_.push_back(path.string());
  write_seconds_ += writing.seconds();
}

}  // namespace tetwarp::cli
