/// @file warper.cpp
/// The public calls: checks of all arguments, the queue of steps, the report.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <tetwarp/version.hpp>
#include <tetwarp/warp.hpp>
#include <tuple>
#include <utility>

#include "host/base/parallel.hpp"
#include "host/base/region_grid.hpp"
#include "host/base/warp_backend.hpp"
#include "host/warp/backend_choice.hpp"
#include "host/warp/curve_checks.hpp"
#include "host/warp/hex_split.hpp"
#include "host/warp/step_queue.hpp"
#include "host/warp/transform_checks.hpp"
#include "kernels/warp/node_quantize.hpp"

namespace tetwarp {
namespace {
/// When a report has twice as many records of steps, the older half is dropped, so that memory does
/// not grow with the length of a series.
constexpr std::ptrdiff_t kept_steps = 500;

void check_ranges(const std::vector<VolumeView>& sources,
                  const std::vector<std::vector<double>>& ranges) {
  if (ranges.size() != sources.size()) {
    throw std::invalid_argument("source window: ranges of " + std::to_string(ranges.size()) +
                                " sources, expected " + std::to_string(sources.size()));
  }
  for (std::size_t s = 0; s < sources.size(); ++s) {
    if (ranges[s].size() != 2 * static_cast<std::size_t>(sources[s].components)) {
      throw std::invalid_argument("source window: range has " + std::to_string(ranges[s].size()) +
                                  " entries, expected two per component");
    }
  }
}

void check_window(const std::vector<VolumeView>& sources, const WarpOptions& options) {
  if (!options.source_window) return;
  const auto& [begin, end] = options.source_window->region;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t count = sources.front().grid.dims[axis];
    if (begin[axis] < 0 || begin[axis] >= end[axis] || end[axis] > count) {
      throw std::invalid_argument("source window: empty or not within the grid on axis " +
                                  std::to_string(axis));
    }
  }
  if (options.filter == Filter::bspline) {
    throw std::invalid_argument(
        "source window: a spline passes through all samples of a source; use another filter");
  }
  if (options.intensity == Intensity::conservative) {
    throw std::invalid_argument("source window: conservative needs the whole source; use density");
  }
  if (options.label_rule != LabelRule::linear) {
    throw std::invalid_argument(std::string("source window: label rule ") +
                                name_of(options.label_rule) +
                                " needs the whole source; use linear");
  }
  if (extends(options.outside)) {
    throw std::invalid_argument(
        std::string("source window: outside ") + name_of(options.outside) +
        " takes displacements from the whole mesh; use background or identity");
  }
  if (options.overshoot == Overshoot::clamp) check_ranges(sources, options.source_window->ranges);
}

WarpPlan make_plan(std::span<const VolumeView> sources,
                   const Mesh& mesh,
                   const WarpOptions& options) {
  WarpPlan plan;
  plan.sources.assign(sources.begin(), sources.end());
  plan.options = options;
  check_sources(plan.sources, "warp");
  check_window(plan.sources, options);
  check_transforms(plan.sources, options);
  check_mesh(mesh);
  plan.mesh = with_split_hexes(mesh);
  thread_count(options.threads);
  const Grid& source_grid = plan.sources.front().grid;
  plan.source_region =
      options.source_window ? options.source_window->region : Region{{0, 0, 0}, source_grid.dims};
  plan.output_grid = options.output_grid.value_or(source_grid);
  check_grid(plan.output_grid, "output grid");
  plan.region = checked_region(plan.output_grid, options.region);
  plan.target_grid = grid_of_region(plan.output_grid, plan.region);
  return plan;
}

WarpPlan make_plan(std::span<const VolumeView> sources,
                   const CurvedMesh& mesh,
                   const WarpOptions& options) {
  WarpPlan plan = make_plan(sources, mesh.mesh, options);
  check_mid_nodes(mesh.mesh, mesh.mid_nodes);
  if (std::ranges::all_of(mesh.mid_nodes, [](const MidNodes& m) { return m == no_mid_nodes; })) {
    return plan;
  }
  const std::string refusal = curves_refusal(options, false);
  if (!refusal.empty()) throw std::invalid_argument(refusal);
  plan.mid_nodes = mesh.mid_nodes;
  return plan;
}

void check_memory_space(const WarpPlan& plan, Backend backend) {
  for (const VolumeView& source : plan.sources) {
    if (source.memory == Memory::device && backend != Backend::cuda) {
      throw std::invalid_argument("source: device memory needs back end cuda");
    }
  }
}

void check_step(const WarpPlan& plan,
                Backend backend,
                const PositionsView& deformed,
                const WarpTarget& target) {
  const std::size_t nodes = plan.mesh.rest_positions.size();
  if (deformed.node_count != static_cast<std::int64_t>(nodes) || deformed.xyz == nullptr) {
    throw std::invalid_argument("deformed positions: expected " + std::to_string(nodes) +
                                " nodes as at rest, got " + std::to_string(deformed.node_count));
  }
  if (deformed.memory == Memory::host) {
    for (std::int64_t n = 0; n < deformed.node_count; ++n) {
      for (int axis = 0; axis < 3; ++axis) {
        if (!std::isfinite(deformed.xyz[3 * n + axis])) {
          throw std::invalid_argument("deformed positions: node " + std::to_string(n) +
                                      " is not finite");
        }
      }
    }
  }
  if (target.volumes.size() != plan.sources.size()) {
    throw std::invalid_argument("target: expected one output per source, " +
                                std::to_string(plan.sources.size()) + ", got " +
                                std::to_string(target.volumes.size()));
  }
  for (const void* volume : target.volumes) {
    if (volume == nullptr) throw std::invalid_argument("target: an output is null");
  }
  if (target.fields.forward != nullptr && plan.output_grid != plan.sources.front().grid) {
    throw std::invalid_argument(
        "target: the forward field is on the source grid, which the output grid is not; leave out "
        "output_grid or the field");
  }
  if (target.fields.forward != nullptr && !plan.mid_nodes.empty()) {
    throw std::invalid_argument("target: " + curves_refusal(plan.options, true));
  }
  const bool on_device = deformed.memory == Memory::device || target.memory == Memory::device ||
                         target.stream != nullptr;
  if (on_device && backend != Backend::cuda) {
    throw std::invalid_argument("device memory and streams need back end cuda");
  }
}

/// What one step takes on the cpu [s], whether or not the arguments are valid.
double cpu_seconds_of(const Volume& source, const Mesh& mesh, const WarpOptions& options) {
  const Grid& grid = options.output_grid ? *options.output_grid : source.grid;
  const Region region = options.region.value_or(Region{{0, 0, 0}, grid.dims});
  double samples = source.components;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    samples *= static_cast<double>(region.end[axis] - region.begin[axis]);
  }
  return estimated_cpu_seconds(options, samples, !mesh.hexes.empty());
}

std::unique_ptr<WarpBackend> make_backend(Backend backend, const WarpPlan& plan) {
  switch (backend) {
    case Backend::cuda:
      return make_cuda_backend(plan);
    case Backend::reference:
      return make_reference_backend(plan);
    default:
      return make_cpu_backend(plan);
  }
}
}  // namespace

struct Warper::State {
  WarpPlan plan;
  Report report;
  std::optional<StepQueue> queue;

  /// Chooses and makes the back end of the plan.
  void start() {
    const WarpOptions& options = plan.options;
    std::tie(report.backend, report.backend_reason) =
        choose_backend(options.backend, options.device);
    check_memory_space(plan, report.backend);
    queue.emplace(make_backend(report.backend, plan));
    report.version = TETWARP_VERSION;
    report.device = queue->backend().device();
    report.threads = queue->backend().threads();
    report.position_quantum = 1.0 / static_cast<double>(quanta_per_voxel);
  }
};

Warper::Warper(std::span<const VolumeView> sources, const Mesh& mesh, const WarpOptions& options)
    : state_(std::make_unique<State>()) {
  state_->plan = make_plan(sources, mesh, options);
  state_->start();
}

Warper::Warper(std::span<const VolumeView> sources,
               const CurvedMesh& mesh,
               const WarpOptions& options)
    : state_(std::make_unique<State>()) {
  state_->plan = make_plan(sources, mesh, options);
  state_->start();
}

Warper::Warper(const Volume& source, const Mesh& mesh, const WarpOptions& options)
    : Warper(std::array{VolumeView(source)}, mesh, options) {}

Warper::Warper(Warper&&) noexcept = default;
Warper& Warper::operator=(Warper&&) noexcept = default;
Warper::~Warper() = default;

const Grid& Warper::output_grid() const {
  return state_->plan.target_grid;
}

const Report& Warper::report() const {
  return state_->report;
}

void Warper::begin_step(const PositionsView& deformed,
                        const WarpTarget& target,
                        const Progress& progress) {
  check_step(state_->plan, state_->report.backend, deformed, target);
  StepQueue& queue = *state_->queue;
  if (queue.size() == max_steps_in_flight) {
    throw std::logic_error("begin_step: two steps are in flight; finish one first");
  }
  if (queue.writes_to(target)) {
    throw std::invalid_argument("target: a step in flight writes to it");
  }
  queue.begin(deformed, target, progress);
}

StepReport Warper::finish_step() {
  if (state_->queue->size() == 0) throw std::logic_error("finish_step: no step is in flight");
  StepReport step = state_->queue->finish();
  Report& report = state_->report;
  step.step = report.steps.empty() ? 0 : report.steps.back().step + 1;
  report.timings += step.timings;
  report.counts += step.counts;
  if (std::ssize(report.steps) == 2 * kept_steps) {
    report.steps.erase(report.steps.begin(), report.steps.begin() + kept_steps);
  }
  report.steps.push_back(step);
  return step;
}

std::size_t Warper::steps_in_flight() const {
  return state_->queue->size();
}

StepReport Warper::step(const PositionsView& deformed,
                        const WarpTarget& target,
                        const Progress& progress) {
  if (steps_in_flight() > 0) {
    throw std::logic_error("step: others are in flight; finish them first");
  }
  begin_step(deformed, target, progress);
  return finish_step();
}

Volume Warper::step(const PositionsView& deformed) {
  if (state_->plan.sources.size() != 1) {
    throw std::invalid_argument("step into a new volume: the Warper has several sources");
  }
  const VolumeView& source = state_->plan.sources.front();
  Volume volume = make_volume(output_grid(), source.type, source.components);
  void* const data = volume.data.data();
  step(deformed, {.volumes = std::span(&data, 1)});
  return volume;
}

WarpResult warp(const Volume& source,
                const Mesh& mesh,
                const std::vector<Point3>& deformed,
                const WarpOptions& options) {
  WarpOptions chosen = options;
  std::optional<std::string> reason;
  if (options.backend == Backend::automatic) {
    std::tie(chosen.backend, reason) =
        choose_backend_for(cpu_seconds_of(source, mesh, options), options);
  }
  Warper warper(source, mesh, chosen);
  WarpResult result{warper.step(deformed), warper.report()};
  result.volume.name = source.name;
  if (reason) result.report.backend_reason = *reason;
  return result;
}

}  // namespace tetwarp
