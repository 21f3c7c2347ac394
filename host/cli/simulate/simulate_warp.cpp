/// @file simulate_warp.cpp
/// Warps of the volumes that bodies are made of.
#include "host/cli/simulate/simulate_warp.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>
#include <tetwarp/io.hpp>
#include <variant>

#include "host/base/stopwatch.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/interrupt.hpp"

namespace tetwarp::cli {
namespace {
bool is_equal(const Grid& a, const Grid& b) {
  return a.dims == b.dims && a.origin == b.origin && a.spacing == b.spacing &&
         a.direction == b.direction;
}
}  // namespace

BodyWarps::BodyWarps(const Simulator& simulator, const SimulateArguments& arguments)
    : simulator_(simulator), arguments_(arguments) {
  const std::vector<Body>& bodies = simulator.scene().bodies;
  std::vector<std::string> names;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto* image = std::get_if<ImageGeometry>(&bodies[b].geometry);
    if (image == nullptr || simulator.body(b).mesh.cell_count() == 0) continue;
    names.push_back(bodies[b].name);
    if (!arguments.warped_body.empty() && arguments.warped_body != bodies[b].name) continue;
    followers_.push_back({b, &image->volume, {}, {}});
  }
  if (followers_.empty()) {
    const std::string found = names.empty() ? "none is" : "those are " + listed(names);
    throw std::invalid_argument(
        arguments.scene() + ": --warp: " +
        (arguments.warped_body.empty() ? "no body" : "no body '" + arguments.warped_body + "'") +
        " made of a volume; " + found);
  }
  for (Follower& follower : followers_) {
    try {
      prepare(follower);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(bodies[follower.body].name + ": --warp: " + error.what());
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
  const Grid grid = resolve_grid(arguments_.grid, follower.source->grid, mesh,
                                 [&] { return simulator_.node_positions(follower.body); });
  if (follower.warper && is_equal(grid, follower.grid)) return;
  follower.grid = grid;
  follower.warper.emplace(*follower.source, mesh, options_of(follower));
}

void BodyWarps::write_frame(std::int64_t frame) {
  for (Follower& follower : followers_) {
    const Stopwatch warping;
    prepare(follower);
    const VolumeView source(*follower.source);
    Volume warped =
        make_volume(follower.grid, source.type, source.components, follower.source->name);
    void* const samples = warped.data.data();
    follower.warper->step(simulator_.positions(follower.body), {.volumes = {&samples, 1}},
                          [](double) { return !is_interrupted(); });
    warp_seconds_ += warping.seconds();
    const Stopwatch writing;
    const std::string name = simulator_.scene().bodies[follower.body].name;
    const std::filesystem::path path = std::filesystem::path(arguments_.folder) /
                                       fmt::format("{}.warped_{:04}.vtkhdf", name, frame);
    write_volumes(path.string(), {&warped},
                  {.compress = arguments_.compress, .background = arguments_.warp.background});
    paths_.push_back(path.string());
    write_seconds_ += writing.seconds();
  }
}

}  // namespace tetwarp::cli
