/// @file simulate_series.cpp
/// The list of columns and how each is filled.
#include "host/cli/simulate/simulate_series.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host/base/step_second_fields.hpp"
#include "host/cli/simulate/simulate_frames.hpp"

namespace tetwarp::cli {

StepSeries::StepSeries(const Scene& scene) {
  add_totals();
  add_seconds();
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) add_body(scene.bodies[b], b);
  const std::vector<std::string> obstacles = obstacle_names(scene);
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    add_vector("obstacles/" + obstacles[o] + "/contact_force", [o](const StepRecord& record) {
      return o < record.obstacle_forces.size() ? record.obstacle_forces[o] : Point3{0, 0, 0};
    });
  }
  const std::vector<std::string> couplings = coupling_names(scene);
  for (std::size_t c = 0; c < couplings.size(); ++c) {
    add_vector("couplings/" + couplings[c] + "/force",
               [c](const StepRecord& record) { return record.coupling_forces.at(c); });
  }
}

void StepSeries::add(const std::string& path, int components, bool is_integer, Fill fill) {
  columns_.push_back({path, components, is_integer});
  fills_.push_back(std::move(fill));
  const bool is_place = path == "time" || path.ends_with("/centre") || path.ends_with("/rotation");
  summary_of_.push_back(is_place ? -1 : static_cast<int>(summaries_.size()));
  if (!is_place) summaries_.push_back({path});
}

void StepSeries::add_number(const std::string& path,
                            std::function<double(const StepRecord&)> value) {
  add(path, 1, false, [value = std::move(value)](const StepRecord& record, auto& row) {
    row.push_back(value(record));
  });
}

void StepSeries::add_count(const std::string& path,
                           std::function<std::int64_t(const StepRecord&)> value) {
  add(path, 1, true, [value = std::move(value)](const StepRecord& record, auto& row) {
    row.push_back(static_cast<double>(value(record)));
  });
}

void StepSeries::add_vector(const std::string& path,
                            std::function<Point3(const StepRecord&)> value) {
  add(path, 3, false, [value = std::move(value)](const StepRecord& record, auto& row) {
    const Point3 vector = value(record);
    row.insert(row.end(), vector.begin(), vector.end());
  });
}

void StepSeries::add_totals() {
  using Record = const StepRecord&;
  add_number("time", [](Record r) { return r.time; });
  add_number("energy/kinetic", [](Record r) { return r.energy.kinetic; });
  add_number("energy/elastic", [](Record r) { return r.energy.elastic; });
  add_number("energy/gravity", [](Record r) { return r.energy.gravity; });
  add_number("energy/adhesion", [](Record r) { return r.energy.adhesion; });
  add_number("energy/total", [](Record r) { return r.energy.total(); });
  add_number("energy/work", [](Record r) { return r.energy.work; });
  add_vector("momentum", [](Record r) { return r.momentum; });
  add_vector("angular_momentum", [](Record r) { return r.angular_momentum; });
  add_count("contacts", [](Record r) { return r.contacts; });
  add_count("contact_passes", [](Record r) { return r.contact_passes; });
  add_count("substeps", [](Record r) { return r.substeps; });
  add_count("clamped_islands", [](Record r) { return r.clamped_islands; });
  add_count("stalled_scripts", [](Record r) { return r.stalled_scripts; });
  add_count("inverted", [](Record r) { return r.inverted; });
  add_count("islands", [](Record r) { return r.islands; });
  add_count("sleeping", [](Record r) { return r.sleeping; });
  add_count("linear_iterations", [](Record r) { return r.linear_iterations; });
  add_number("linear_residual", [](Record r) { return r.linear_residual; });
  add_count("converged", [](Record r) { return std::int64_t{r.converged}; });
  add_count("out_of_time", [](Record r) { return std::int64_t{r.out_of_time}; });
  add_count("sweeps", [](Record r) { return r.sweeps; });
  add_count("outer_iterations", [](Record r) { return r.outer_iterations; });
  add_number("contact_residual", [](Record r) { return r.contact_residual; });
  add_number("smallest_distance", [](Record r) { return r.smallest_distance; });
  add_number("adhered_area", [](Record r) { return r.adhered_area; });
}

void StepSeries::add_seconds() {
  for (const auto& [name, member] : step_second_fields) {
    add_number(std::string("seconds/") + name,
               [member = member](const StepRecord& record) { return record.seconds.*member; });
  }
}

void StepSeries::add_body(const Body& body, std::size_t index) {
  static constexpr std::array<std::pair<const char*, Point3 BodyRecord::*>, 8> vectors{
      {{"centre", &BodyRecord::center},
       {"velocity", &BodyRecord::velocity},
       {"angular_momentum", &BodyRecord::angular_momentum},
       {"contact_force", &BodyRecord::contact_force},
       {"support_force", &BodyRecord::support_force},
       {"handle_force", &BodyRecord::handle_force},
       {"coupling_force", &BodyRecord::coupling_force},
       {"load_force", &BodyRecord::load_force}}};
  const std::string group = "bodies/" + body.name + "/";
  for (const auto& [name, member] : vectors) {
    add_vector(group + name, [index, member = member](const StepRecord& record) {
      return record.bodies.at(index).*member;
    });
  }
  if (body.kind != BodyKind::rigid) return;
  add(group + "rotation", 4, false, [index](const StepRecord& record, auto& row) {
    const std::array<double, 4>& rotation = record.bodies.at(index).rotation;
    row.insert(row.end(), rotation.begin(), rotation.end());
  });
  add_vector(group + "angular_velocity", [index](const StepRecord& record) {
    return record.bodies.at(index).angular_velocity;
  });
}

const std::vector<double>& StepSeries::row_of(const StepRecord& record) {
  row_.clear();
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const std::size_t first = row_.size();
    fills_[c](record, row_);
    if (summary_of_[c] < 0) continue;
    double value = row_[first];
    if (columns_[c].components > 1) {
      double squares = 0;
      for (std::size_t n = first; n < row_.size(); ++n) squares += row_[n] * row_[n];
      value = std::sqrt(squares);
    }
    SeriesSummary& summary = summaries_[static_cast<std::size_t>(summary_of_[c])];
    summary.sum += value;
    summary.max = std::max(summary.max, value);
  }
  ++row_count_;
  return row_;
}

}  // namespace tetwarp::cli
