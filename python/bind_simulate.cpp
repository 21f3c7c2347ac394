/// @file bind_simulate.cpp
/// Scenes and the Simulator.
#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <atomic>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tetwarp/scene_io.hpp>
#include <tetwarp/simulate.hpp>
#include <utility>
#include <variant>
#include <vector>

#include "python/arrays.hpp"
#include "python/bind.hpp"
#include "python/choices.hpp"
#include "python/file_call.hpp"
#include "python/interpreter_lock.hpp"
#include "python/interruption.hpp"

namespace tetwarp::python {
namespace {
nb::tuple tuple_of(const Point3& x) {
  return nb::make_tuple(x[0], x[1], x[2]);
}

nb::dict dict_of(const BodyRecord& body) {
  nb::dict all;
  all["center"] = tuple_of(body.center);
  all["velocity"] = tuple_of(body.velocity);
  all["angular_momentum"] = tuple_of(body.angular_momentum);
  all["contact_force"] = tuple_of(body.contact_force);
  all["support_force"] = tuple_of(body.support_force);
  all["handle_force"] = tuple_of(body.handle_force);
  all["coupling_force"] = tuple_of(body.coupling_force);
  all["load_force"] = tuple_of(body.load_force);
  all["rotation"] =
      nb::make_tuple(body.rotation[0], body.rotation[1], body.rotation[2], body.rotation[3]);
  all["angular_velocity"] = tuple_of(body.angular_velocity);
  return all;
}

nb::dict dict_of(const SceneEnergy& energy) {
  nb::dict all;
  all["kinetic"] = energy.kinetic;
  all["elastic"] = energy.elastic;
  all["gravity"] = energy.gravity;
  all["adhesion"] = energy.adhesion;
  all["work"] = energy.work;
  all["total"] = energy.total();
  return all;
}

nb::dict dict_of(const StepSeconds& seconds) {
  nb::dict all;
  all["forces"] = seconds.forces;
  all["assembly"] = seconds.assembly;
  all["linear"] = seconds.linear;
  all["detection"] = seconds.detection;
  all["contact"] = seconds.contact;
  all["update"] = seconds.update;
  all["total"] = seconds.total;
  return all;
}

nb::dict dict_of(const StepRecord& record) {
  nb::dict all;
  all["time"] = record.time;
  all["energy"] = dict_of(record.energy);
  all["momentum"] = tuple_of(record.momentum);
  all["angular_momentum"] = tuple_of(record.angular_momentum);
  all["inverted"] = record.inverted;
  all["islands"] = record.islands;
  all["sleeping"] = record.sleeping;
  all["substeps"] = record.substeps;
  all["linear_iterations"] = record.linear_iterations;
  all["linear_residual"] = record.linear_residual;
  all["converged"] = record.converged;
  all["out_of_time"] = record.out_of_time;
  all["contacts"] = record.contacts;
  all["contact_passes"] = record.contact_passes;
  all["clamped_islands"] = record.clamped_islands;
  all["stalled_scripts"] = record.stalled_scripts;
  all["sweeps"] = record.sweeps;
  all["outer_iterations"] = record.outer_iterations;
  all["contact_residual"] = record.contact_residual;
  all["smallest_distance"] = record.smallest_distance;
  all["adhered_area"] = record.adhered_area;
  all["seconds"] = dict_of(record.seconds);
  nb::list bodies;
  for (const BodyRecord& body : record.bodies) bodies.append(dict_of(body));
  all["bodies"] = bodies;
  all["obstacle_forces"] = array_of(record.obstacle_forces);
  all["coupling_forces"] = array_of(record.coupling_forces);
  return all;
}

/// One array per member of ContactPoint.
nb::dict dict_of(const std::vector<ContactPoint>& contacts) {
  std::vector<std::int64_t> body_a, body_b;
  std::vector<Point3> position, normal, impulse;
  std::vector<double> gap, area, intensity;
  for (const ContactPoint& contact : contacts) {
    body_a.push_back(static_cast<std::int64_t>(contact.body_a));
    body_b.push_back(static_cast<std::int64_t>(contact.body_b));
    position.push_back(contact.position);
    normal.push_back(contact.normal);
    impulse.push_back(contact.impulse);
    gap.push_back(contact.gap);
    area.push_back(contact.area);
    intensity.push_back(contact.intensity);
  }
  nb::dict all;
  all["body_a"] = array_of(std::move(body_a));
  all["body_b"] = array_of(std::move(body_b));
  all["position"] = array_of(std::move(position));
  all["normal"] = array_of(std::move(normal));
  all["impulse"] = array_of(std::move(impulse));
  all["gap"] = array_of(std::move(gap));
  all["area"] = array_of(std::move(area));
  all["intensity"] = array_of(std::move(intensity));
  return all;
}

/// A Simulator whose steps Python can end.
class SceneSimulator {
 public:
  SceneSimulator(Scene scene, SimulateOptions options) {
    options.progress = [this](const StepProgress& progress) {
      return interruption_ == nullptr ||
             interruption_->go_on(progress.step, progress.time, progress.linear_iterations);
    };
    const LockReleased release;
    simulator_.emplace(std::move(scene), options);
  }

  bool step(nb::object progress) {
    const OneCall call(is_running_, "Simulator");
    Interruption interruption(std::move(progress));
    interruption_ = &interruption;
    const Reset reset{interruption_};
    const bool is_done = interruption.run([&] { return simulator_->step(); });
    interruption.throw_error();
    return is_done;
  }

  /// @throws std::runtime_error  a step is running, in another thread or above its callback
  Simulator& idle() {
    if (is_running_) throw std::runtime_error("Simulator: a step of this object is running");
    return *simulator_;
  }

 private:
  struct Reset {
    Interruption*& pointer;
    ~Reset() { pointer = nullptr; }
  };

  Interruption* interruption_ = nullptr;
  std::optional<Simulator> simulator_;
  std::atomic<bool> is_running_ = false;
};

/// @param text  a scene, or empty: `file` is read
Scene load_scene(const std::string& file, const std::string& text, const std::string& folder) {
  return file_call(
      [&] { return text.empty() ? read_scene(file) : parse_scene(text, file, folder); });
}

template <class Parts>
nb::list names_in(const Parts& parts) {
  nb::list names;
  for (const auto& part : parts) names.append(part.name);
  return names;
}

nb::dict dict_of(const BodyMesh& body) {
  nb::dict all;
  all["kind"] = name_of(body.kind);
  all["mass"] = body.mass;
  all["points"] = array_of(body.mesh.rest_positions);
  all["tets"] = array_of(body.mesh.tets);
  all["surface_points"] = array_of(body.surface.points);
  all["surface_triangles"] = array_of(body.surface.triangles);
  return all;
}

/// Samples and grid of the image that a body is made of, or None. The array keeps `self` alive.
nb::object image_of(nb::handle self, std::size_t index) {
  const Simulator& simulator = nb::cast<SceneSimulator&>(self).idle();
  const auto* image = std::get_if<ImageGeometry>(&simulator.scene().bodies.at(index).geometry);
  if (image == nullptr) return nb::none();
  const Volume& volume = image->volume;
  const auto size = [&](std::size_t axis) {
    return static_cast<std::size_t>(volume.grid.dims[axis]);
  };
  const std::array<std::size_t, 4> shape{size(2), size(1), size(0),
                                         static_cast<std::size_t>(volume.components)};
  const nb::ndarray<nb::numpy, nb::ro> samples(volume.data.data(), volume.components == 1 ? 3 : 4,
                                               shape.data(), self, nullptr, dtype_of(volume.type));
  return nb::make_tuple(samples, volume.grid, volume.name);
}
}  // namespace

void bind_simulate(nb::module_& module) {
  module.def("scene_names", &scene_names);
  module.def("scene_text", &scene_text, nb::arg("name"));
  nb::class_<SceneSimulator>(module, "Simulator")
      .def(
          "__init__",
          [](SceneSimulator* self, const std::string& file, const std::string& text,
             const std::string& folder, const std::string& backend, int device, int threads,
             bool untangle, double max_step_seconds) {
            SimulateOptions options;
            options.backend = choice<Backend>("backend", backend);
            options.device = device;
            options.threads = threads;
            options.untangle = untangle;
            options.max_step_seconds = max_step_seconds;
            new (self) SceneSimulator(load_scene(file, text, folder), std::move(options));
          },
          nb::arg("file"), nb::arg("text"), nb::arg("folder"), nb::kw_only(), nb::arg("backend"),
          nb::arg("device"), nb::arg("threads"), nb::arg("untangle"), nb::arg("max_step_seconds"))
      .def("step", &SceneSimulator::step, nb::arg("progress").none())
      .def_prop_ro("names",
                   [](SceneSimulator& self) { return names_in(self.idle().scene().bodies); })
      .def_prop_ro("obstacle_names",
                   [](SceneSimulator& self) { return names_in(self.idle().scene().obstacles); })
      .def_prop_ro("time_step", [](SceneSimulator& self) { return self.idle().scene().time_step; })
      .def_prop_ro("duration", [](SceneSimulator& self) { return self.idle().scene().duration; })
      .def_prop_ro("step_count",
                   [](SceneSimulator& self) { return self.idle().scene().step_count(); })
      .def_prop_ro("step_index", [](SceneSimulator& self) { return self.idle().step_index(); })
      .def_prop_ro("time", [](SceneSimulator& self) { return self.idle().time(); })
      .def_prop_ro("thickness", [](SceneSimulator& self) { return self.idle().thickness(); })
      .def_prop_ro("backend", [](SceneSimulator& self) { return name_of(self.idle().backend()); })
      .def("record", [](SceneSimulator& self) { return dict_of(self.idle().record()); })
      .def("contacts", [](SceneSimulator& self) { return dict_of(self.idle().contacts()); })
      .def(
          "body",
          [](SceneSimulator& self, std::size_t index) { return dict_of(self.idle().body(index)); },
          nb::arg("index"))
      .def(
          "image", [](nb::handle self, std::size_t index) { return image_of(self, index); },
          nb::arg("index"), nb::sig("def image(self, index: int) -> tuple | None"))
      .def(
          "positions",
          [](SceneSimulator& self, std::size_t index) {
            return array_of(self.idle().node_positions(index));
          },
          nb::arg("index"))
      .def(
          "velocities",
          [](SceneSimulator& self, std::size_t index) {
            return array_of(self.idle().node_velocities(index));
          },
          nb::arg("index"))
      .def(
          "surface_positions",
          [](SceneSimulator& self, std::size_t index) {
            return array_of(self.idle().surface_positions(index));
          },
          nb::arg("index"))
      .def(
          "jacobians",
          [](SceneSimulator& self, std::size_t index) {
            return array_of(self.idle().cell_jacobians(index));
          },
          nb::arg("index"))
      .def(
          "stresses",
          [](SceneSimulator& self, std::size_t index) {
            return array_of(self.idle().cell_stresses(index));
          },
          nb::arg("index"))
      .def(
          "add_handle",
          [](SceneSimulator& self, const std::string& name, const std::string& body,
             const Point3& center, double radius, double stiffness, double damping) {
            self.idle().add_handle({name, body, center, radius, stiffness, damping});
          },
          nb::arg("name"), nb::arg("body"), nb::arg("center"), nb::arg("radius"),
          nb::arg("stiffness"), nb::arg("damping"))
      .def(
          "move_handle",
          [](SceneSimulator& self, const std::string& name, const Point3& by) {
            self.idle().move_handle(name, by);
          },
          nb::arg("name"), nb::arg("displacement"))
      .def(
          "release_handle",
          [](SceneSimulator& self, const std::string& name) { self.idle().release_handle(name); },
          nb::arg("name"))
      .def(
          "move_script",
          [](SceneSimulator& self, const std::string& name, const Point3& by, const Point3& turn) {
            self.idle().move_script(name, by, turn);
          },
          nb::arg("name"), nb::arg("displacement"), nb::arg("axis_angle"))
      .def("checkpoint",
           [](SceneSimulator& self) {
             const std::vector<std::byte> state = self.idle().checkpoint();
             return nb::bytes(state.data(), state.size());
           })
      .def(
          "restore",
          [](SceneSimulator& self, const nb::bytes& state) {
            self.idle().restore(
                std::span(static_cast<const std::byte*>(state.data()), state.size()));
          },
          nb::arg("state"));
}

}  // namespace tetwarp::python
