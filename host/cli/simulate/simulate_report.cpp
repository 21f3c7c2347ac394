/// @file simulate_report.cpp
/// The report as JSON.
#include "host/cli/simulate/simulate_report.hpp"

#include <nlohmann/json.hpp>
#include <tetwarp/version.hpp>

#include "host/base/parallel.hpp"
#include "host/cli/common/json_text.hpp"

namespace tetwarp::cli {
namespace {
using Json = nlohmann::ordered_json;

Json json_of_bodies(const Simulator& simulator) {
  Json bodies = Json::object();
  const std::vector<Body>& scene_bodies = simulator.scene().bodies;
  for (std::size_t b = 0; b < scene_bodies.size(); ++b) {
    const BodyMesh& body = simulator.body(b);
    const bool has_nodes = !body.mesh.rest_positions.empty();
    bodies[scene_bodies[b].name] = {
        {"mass", body.mass},
        {"tetrahedra", body.mesh.tets.size()},
        {"nodes", has_nodes ? body.mesh.rest_positions.size() : simulator.node_positions(b).size()},
        {"triangles", body.surface.triangles.size()},
        {"cells_across", body.cells_across}};
    if (body.foreground_volume == 0) continue;
    bodies[scene_bodies[b].name]["foreground_volume"] = body.foreground_volume;
    bodies[scene_bodies[b].name]["uncovered_volume"] = body.uncovered_volume;
  }
  return bodies;
}

Json json_of_series(const StepSeries& series) {
  Json columns = Json::object();
  const auto rows = static_cast<double>(series.row_count());
  if (series.row_count() == 0) return columns;
  for (const SeriesSummary& column : series.summaries()) {
    columns[column.name] = {{"mean", column.sum / rows}, {"max", column.max}};
  }
  return columns;
}
}  // namespace

std::string report_json(const SimulateArguments& arguments,
                        const Simulator& simulator,
                        const StepSeries& series,
                        const SimulateResult& result) {
  Json json;
  json["version"] = TETWARP_VERSION;
  json["scene"] = arguments.scene();
  json["backend"] = name_of(simulator.backend());
  json["device"] = simulator.device();
  json["threads"] =
      simulator.backend() == Backend::cpu ? thread_count(arguments.simulate.threads) : 1;
  json["status"] = !result.error.empty()   ? "failed"
                   : result.is_interrupted ? "interrupted"
                                           : "done";
  if (!result.error.empty()) json["error"] = result.error;
  json["converged"] = result.unconverged_steps == 0;
  json["unconverged_steps"] = result.unconverged_steps;
  json["out_of_time_steps"] = result.late_steps;
  json["first_step"] = result.first_step;
  json["steps_done"] = result.steps_done;
  json["time_step"] = simulator.scene().time_step;
  json["time"] = simulator.time();
  json["thickness"] = simulator.thickness();
  json["frames"] = result.frames;
  json["timings"] = {{"read", result.read_seconds},  {"setup", result.setup_seconds},
                     {"step", result.step_seconds},  {"write", result.write_seconds},
                     {"warp", result.warp_seconds},  {"draw", result.draw_seconds},
                     {"total", result.total_seconds}};
  json["outputs"] = result.outputs;
  json["warnings"] = result.warnings;
  json["bodies"] = json_of_bodies(simulator);
  json["series"] = json_of_series(series);
  return json_text(json, 2);
}

}  // namespace tetwarp::cli
