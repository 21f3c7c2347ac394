/// @file bind_tracker.cpp
/// The contact tracker: contacts, records and places as arrays.
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <tetwarp/contact_tracker.hpp>
#include <utility>
#include <vector>

#include "python/adhesion_fields.hpp"
#include "python/arrays.hpp"
#include "python/bind.hpp"
#include "python/choices.hpp"
#include "python/table.hpp"

namespace tetwarp::python {

/// A key is four numbers.
template <>
struct ColumnOf<ContactKey> {
  using Number = std::int32_t;
  static constexpr std::size_t width = 4;
};

namespace {
/// Both material points of a report, a contact or a record.
template <class Each>
void for_material_points(Each each) {
  each(
      "local_a", [](auto& row) -> auto& { return row.material_a.local; });
  each(
      "local_b", [](auto& row) -> auto& { return row.material_b.local; });
  each(
      "vertices_a", [](auto& row) -> auto& { return row.material_a.vertex; });
  each(
      "vertices_b", [](auto& row) -> auto& { return row.material_b.vertex; });
  each(
      "weights_a", [](auto& row) -> auto& { return row.material_a.weight; });
  each(
      "weights_b", [](auto& row) -> auto& { return row.material_b.weight; });
}

template <class Each>
void for_report_members(Each each) {
  each(
      "keys", [](auto& row) -> auto& { return row.key; });
  each(
      "point_a", [](auto& row) -> auto& { return row.point_a_world; });
  each(
      "point_b", [](auto& row) -> auto& { return row.point_b_world; });
  each(
      "normal", [](auto& row) -> auto& { return row.normal; });
  each(
      "area", [](auto& row) -> auto& { return row.area; });
  each(
      "material", [](auto& row) -> auto& { return row.material; });
  each(
      "tangent", [](auto& row) -> auto& { return row.tangent; });
  each(
      "approach_speed", [](auto& row) -> auto& { return row.approach_speed; });
  each(
      "surface_velocity", [](auto& row) -> auto& { return row.surface_velocity; });
  each(
      "obstacle_velocity", [](auto& row) -> auto& { return row.obstacle_velocity; });
  each(
      "bonded_share", [](auto& row) -> auto& { return row.bonded_share; });
  for_material_points(each);
}

template <class Each>
void for_contact_members(Each each) {
  each(
      "keys", [](auto& row) -> auto& { return row.key; });
  each(
      "point_a", [](auto& row) -> auto& { return row.point_a_world; });
  each(
      "point_b", [](auto& row) -> auto& { return row.point_b_world; });
  each(
      "axes", [](auto& row) -> auto& { return row.axes; });
  each(
      "gap", [](auto& row) -> auto& { return row.gap; });
  each(
      "is_reported", [](auto& row) -> auto& { return row.is_reported; });
  each(
      "surface_velocity", [](auto& row) -> auto& { return row.surface_velocity; });
  each(
      "obstacle_velocity", [](auto& row) -> auto& { return row.obstacle_velocity; });
  each(
      "rebound_speed", [](auto& row) -> auto& { return row.rebound_speed; });
  for_material_points(each);
}

template <class Each>
void for_record_members(Each each) {
  each(
      "keys", [](auto& row) -> auto& { return row.key; });
  each(
      "material", [](auto& row) -> auto& { return row.material; });
  each(
      "has_touched", [](auto& row) -> auto& { return row.has_touched; });
  each(
      "area", [](auto& row) -> auto& { return row.area; });
  each(
      "intensity", [](auto& row) -> auto& { return row.intensity; });
  each(
      "anchor_a", [](auto& row) -> auto& { return row.anchor_a; });
  each(
      "anchor_b", [](auto& row) -> auto& { return row.anchor_b; });
  each(
      "normal_a", [](auto& row) -> auto& { return row.normal_a; });
  each(
      "normal_b", [](auto& row) -> auto& { return row.normal_b; });
  each(
      "impulse", [](auto& row) -> auto& { return row.impulse_world; });
  each(
      "standoff", [](auto& row) -> auto& { return row.standoff; });
  each(
      "normal", [](auto& row) -> auto& { return row.normal_world; });
  for_material_points(each);
}

template <class Row, class Members>
std::vector<Row> rows_of(std::size_t count, const nb::dict& table, Members for_members) {
  std::vector<Row> rows(count);
  for_members([&](const char* name, auto field) { read_column(table, name, rows, field); });
  return rows;
}

template <class Row, class Members>
nb::dict table_of(const std::vector<Row>& rows, Members for_members) {
  nb::dict table;
  for_members([&](const char* name, auto field) { write_column(table, name, rows, field); });
  return table;
}

/// Per body vertices (n, 3), or of a rigid body position and rotation, (7,).
struct Places {
  explicit Places(const nb::list& bodies) {
    for (const nb::handle body : bodies) {
      const auto numbers = nb::cast<In<double>>(body, false);
      if (numbers.ndim() == 2) {
        vertices.push_back(points_of(nb::cast<InPoints>(body, false)));
        places.push_back({.vertices = vertices.back()});
        continue;
      }
      const double* const x = numbers.data();
      places.push_back({.pose = {{x[0], x[1], x[2]}, {x[3], x[4], x[5], x[6]}}});
      vertices.emplace_back();
    }
  }

  std::vector<std::vector<Point3>>
      vertices;  ///< moving one keeps the memory that a place points to
  std::vector<BodyPlace> places;
};

ContactMaterial material_of(const nb::dict& all) {
  ContactMaterial material;
  const auto read = [&](const char* name, double& number) {
    if (all.contains(name)) number = nb::cast<double>(all[name]);
  };
  read("friction", material.friction);
  read("stiffness", material.stiffness);
  read("energy", material.energy);
  read("viscosity", material.viscosity);
  read("bonding_rate", material.bonding_rate);
  read("saturation_pressure", material.saturation_pressure);
  read("initial_intensity", material.initial_intensity);
  read("restitution", material.restitution);
  if (all.contains("tangential_stiffness")) {
    material.tangential_stiffness = nb::cast<double>(all["tangential_stiffness"]);
  }
  return material;
}

/// @throws std::invalid_argument  records have not the members that a tracker gives
void check_members(const nb::dict& records) {
  std::size_t known = 0;
  for_record_members([&](const char* name, auto) {
    if (!records.contains(name)) {
      throw std::invalid_argument("records: has no '" + std::string(name) +
                                  "', expected the table of a tracker");
    }
    ++known;
  });
  if (records.size() != known) {
    throw std::invalid_argument("records: has " + std::to_string(records.size()) +
                                " members, expected the " + std::to_string(known) +
                                " of a tracker");
  }
}

void make_tracker(ContactTracker* self,
                  const std::vector<nb::dict>& materials,
                  const nb::dict& numbers,
                  const std::string& integrator,
                  int threads,
                  std::size_t record_count,
                  const nb::dict& records) {
  ContactTrackerOptions options;
  options.materials.clear();
  for (const nb::dict& material : materials) options.materials.push_back(material_of(material));
  const auto number = [&](const char* name) { return nb::cast<double>(numbers[name]); };
  options.match_distance = number("match_distance");
  options.touch_distance = number("touch_distance");
  options.restitution_speed = number("restitution_speed");
  options.evolution = {.integrator = choice<AdhesionIntegrator>("integrator", integrator),
                       .debond_gap_factor = number("debond_gap_factor"),
                       .debond_intensity = number("debond_intensity")};
  options.threads = threads;
  if (records.size() > 0) check_members(records);
  new (self) ContactTracker(
      std::move(options),
      rows_of<ContactRecord>(record_count, records, [](auto each) { for_record_members(each); }));
}

nb::dict begin_step(ContactTracker& tracker,
                    std::size_t count,
                    const nb::dict& reports,
                    const nb::list& bodies,
                    double time_step) {
  const auto rows =
      rows_of<ReportedContact>(count, reports, [](auto each) { for_report_members(each); });
  const Places places(bodies);
  return table_of(tracker.begin_step(rows, std::span<const BodyPlace>(places.places), time_step),
                  [](auto each) { for_contact_members(each); });
}

/// What a problem in global form gets of the step.
nb::dict fill(const ContactTracker& tracker) {
  ContactProblem problem;
  tracker.fill(problem);
  nb::dict all;
  all["friction"] = array_of(std::move(problem.friction));
  all["velocity_offset"] = array_of(std::move(problem.velocity_offset));
  all["impulse_guess"] = array_of(std::move(problem.impulse_guess));
  all["adhesion"] = adhesion_dict(std::move(problem.adhesion));
  return all;
}

nb::dict end_step(ContactTracker& tracker,
                  const In<double>& impulse,
                  const In<double>& velocity,
                  const In<double>& pressing,
                  const nb::list& bodies) {
  ContactSolution solution;
  solution.impulse = vector_of(impulse);
  solution.velocity = vector_of(velocity);
  const Places places(bodies);
  AdhesionStep step = tracker.end_step(solution, std::span<const BodyPlace>(places.places),
                                       {pressing.data(), pressing.size()});
  const std::size_t count = step.intensity.size();
  nb::dict all;
  all["intensity"] = array_of(std::move(step.intensity));
  all["gap"] = array_of<double>(std::move(step.gap), {count, 3});
  all["debonded"] = array_of(std::move(step.debonded));
  return all;
}
}  // namespace

void bind_tracker(nb::module_& module) {
  nb::class_<ContactTracker>(module, "ContactTracker")
      .def("__init__", &make_tracker, nb::arg("materials"), nb::arg("numbers"),
           nb::arg("integrator"), nb::arg("threads"), nb::arg("record_count"), nb::arg("records"))
      .def("begin_step", &begin_step, nb::arg("count"), nb::arg("contacts"), nb::arg("bodies"),
           nb::arg("time_step"))
      .def("fill", &fill)
      .def("end_step", &end_step, nb::arg("impulse"), nb::arg("velocity"), nb::arg("pressing"),
           nb::arg("bodies"))
      .def("records", [](const ContactTracker& tracker) {
        return table_of(tracker.records(), [](auto each) { for_record_members(each); });
      });
}

}  // namespace tetwarp::python
