#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"
#include "host/simulate/run/checkpoint.hpp"
#include "host/simulate/run/simulator_impl.hpp"
#include "host/simulate/step/scene_record.hpp"

namespace tetwarp {
namespace {

constexpr std::uint64_t checkpoint_kind = 0x7477'7363'0000'0000;  // "twsc", then the version
constexpr std::uint64_t checkpoint_version = checkpoint_kind + 5;

// Each of these functions writes with a CheckpointWriter and reads with a CheckpointReader.

template <class Stream, class Record>
void pass_record(Stream& stream, Record& record) {
  stream(record.key.body_a);
  stream(record.key.feature_a);
  stream(record.key.body_b);
  stream(record.key.feature_b);
  stream(record.material);
  stream(record.has_touched);
  stream(record.area);
  stream(record.intensity);
  stream(record.anchor_a);
  stream(record.anchor_b);
  stream(record.normal_a);
  stream(record.normal_b);
  stream(record.impulse_world);
  for (auto* point : {&record.material_a, &record.material_b}) {
    stream(point->local);
    stream(point->vertex);
    stream(point->weight);
  }
  stream(record.standoff);
  stream(record.normal_world);
}

template <class Stream, class Point>
void pass_point(Stream& stream, Point& point) {
  stream(point.body_a);
  stream(point.body_b);
  stream(point.position);
  stream(point.normal);
  stream(point.impulse);
  stream(point.gap);
  stream(point.area);
  stream(point.intensity);
  stream(point.place_a.point);
  stream(point.place_a.weight);
  stream(point.place_b.point);
  stream(point.place_b.weight);
}

template <class Stream, class Contact>
void pass_sleeping(Stream& stream, Contact& sleeping) {
  pass_record(stream, sleeping.record);
  pass_point(stream, sleeping.point);
  stream(sleeping.time_step);
  auto& contact = sleeping.contact;
  stream(contact.point_a_world);
  stream(contact.point_b_world);
  for (auto* point : {&contact.material_a, &contact.material_b}) {
    stream(point->local);
    stream(point->vertex);
    stream(point->weight);
  }
  stream(contact.axes);
}

template <class Stream, class Part>
void pass_part(Stream& stream, Part& part) {
  stream(part.converged);
  stream(part.residual);
  stream(part.contacts);
  stream(part.islands);
  stream(part.passes);
  stream(part.sweeps);
  stream(part.outer_iterations);
  stream(part.clamped_islands);
  stream(part.stalled_scripts);
}

template <class Stream, class Sums>
void pass_sums(Stream& stream, Sums& sums) {
  for (auto* list : {&sums.support, &sums.handle, &sums.coupling, &sums.load, &sums.contact,
                     &sums.obstacle, &sums.on_a}) {
    stream(*list);
  }
}

template <class Stream, class State>
void pass_state(Stream& stream, State& state) {
  stream(state.position);
  stream(state.rotation);
  stream(state.velocity);
  stream(state.angular_momentum);
}

bool has_checksum(std::span<const std::byte> bytes) {
  std::uint64_t checksum = 0;
  if (bytes.size() < sizeof checksum) return false;
  const auto of_bytes = bytes.first(bytes.size() - sizeof checksum);
  std::memcpy(&checksum, bytes.data() + of_bytes.size(), sizeof checksum);
  return checksum == checksum_of(of_bytes);
}

[[noreturn]] void refuse_contact() {
  throw std::invalid_argument("checkpoint: damaged, a contact is not on bodies of its scene");
}

/// Bodies and vertices of contacts exist; the tracker checks the rest.
void check_contacts(const ContactMemory& memory, const SceneSurfaces& scene) {
  const auto check_side = [&](std::int32_t body, const MaterialPoint& point) {
    if (body < 0 || body >= scene.body_count()) refuse_contact();
    const CollisionBody& of = at(scene.surfaces.bodies, body);
    for (const std::int32_t vertex : point.vertex) {
      if (vertex >= of.vertex_end - of.first_vertex) refuse_contact();
    }
  };
  const auto check_record = [&](const ContactRecord& record) {
    check_side(record.key.body_a, record.material_a);
    check_side(record.key.body_b, record.material_b);
  };
  std::ranges::for_each(memory.records, check_record);
  for (const SleepingContact& sleeping : memory.sleeping) {
    const ContactKey& key = sleeping.record.key;
    check_record(sleeping.record);
    check_side(key.body_a, sleeping.contact.material_a);
    check_side(key.body_b, sleeping.contact.material_b);
    if (sleeping.point.body_a != index_of(key.body_a) ||
        sleeping.point.body_b != index_of(key.body_b) || !(sleeping.time_step > 0)) {
      refuse_contact();
    }
  }
}

void check_points(const std::vector<ContactPoint>& points,
                  const SceneSurfaces& scene,
                  const std::vector<BodyMesh>& meshes) {
  const auto check_side = [&](std::size_t body, const ContactPlace& place) {
    if (body >= scene.surfaces.bodies.size()) refuse_contact();
    const std::int64_t count = body < meshes.size() ? std::ssize(meshes[body].surface.points) : 0;
    for (const std::int32_t point : place.point) {
      if (point >= count) refuse_contact();
    }
  };
  for (const ContactPoint& point : points) {
    check_side(point.body_a, point.place_a);
    check_side(point.body_b, point.place_b);
  }
}

}  // namespace

/// What a checkpoint holds, besides its version and fingerprint.
struct Simulator::Impl::Saved {
  std::int64_t steps = 0, substeps = 0, held_steps = 0, undivided_steps = 0;
  double work = 0;
  StepOutcome outcome;
  ContactPart contact;
  ModelState state;
  StepSums sums;
  std::vector<std::optional<Point3>> handles;
  DriveOverrides overrides;
  std::vector<double> delays;
  ContactMemory memory;
  SleepState sleep;
  std::vector<ContactPoint> points;

  template <class Stream, class Self>
  static void pass(Stream& stream, Self& saved) {
    stream(saved.steps);
    stream(saved.work);
    stream(saved.substeps);
    stream(saved.held_steps);
    stream(saved.undivided_steps);
    stream(saved.outcome.linear_iterations);
    stream(saved.outcome.linear_residual);
    stream(saved.outcome.converged);
    pass_part(stream, saved.contact);
    pass_state(stream, saved.state);
    pass_sums(stream, saved.sums);
    for (auto& handle : saved.handles) stream(handle);
    for (auto& handle : saved.overrides.handles) stream(handle);
    for (auto& script : saved.overrides.scripts) stream(script);
    stream(saved.delays);
    stream(saved.memory.time_step);
    stream.pass_list(saved.memory.records, [](auto& of, auto& record) { pass_record(of, record); });
    stream.pass_list(saved.memory.change, [](auto& of, auto& change) { of(change); });
    stream.pass_list(saved.memory.sleeping,
                     [](auto& of, auto& contact) { pass_sleeping(of, contact); });
    stream(saved.sleep.is_asleep);
    stream(saved.sleep.calm_time);
    stream(saved.sleep.inputs);
    stream.pass_list(saved.points, [](auto& of, auto& point) { pass_point(of, point); });
  }
};

Simulator::Impl::Saved Simulator::Impl::saved() const {
  Saved now;
  now.steps = step_index;
  now.work = work_;
  now.substeps = substeps_;
  now.held_steps = held_steps_;
  now.undivided_steps = undivided_steps_;
  now.outcome = outcome_;
  now.contact = contact_of_step_;
  now.state = state();
  now.sums = sums_;
  now.handles = drive.handles();
  now.overrides = drive.overrides();
  now.delays = drive.delays();
  if (contact_) contact_->remember(now.memory);
  now.sleep = sleep_.state();
  now.points = contact_points;
  return now;
}

std::vector<std::byte> Simulator::Impl::checkpoint() const {
  CheckpointWriter writer;
  writer.add(checkpoint_version);
  writer.add(fingerprint_of(scene, geometry, options, model, contact_surfaces));
  const Saved now = saved();
  Saved::pass(writer, now);
  writer.add(checksum_of(writer.bytes()));
  return writer.take();
}

void Simulator::Impl::restore(std::span<const std::byte> bytes) {
  CheckpointReader reader(bytes);
  std::uint64_t version = 0, fingerprint = 0;
  reader.read(version);
  if (version != checkpoint_version) {
    throw std::invalid_argument(
        version >> 32 == checkpoint_kind >> 32
            ? "checkpoint: written by another version of tetwarp, which cannot be continued; run "
              "the scene from its start"
            : "checkpoint: not a checkpoint of this version of tetwarp on this kind of machine");
  }
  if (!has_checksum(bytes)) {
    throw std::invalid_argument(
        "checkpoint: damaged or incomplete, its checksum is another; use an earlier one");
  }
  reader.read(fingerprint);
  if (fingerprint != fingerprint_of(scene, geometry, options, model, contact_surfaces)) {
    throw std::invalid_argument(
        "checkpoint: it belongs to another scene; restart the scene that wrote it, unchanged");
  }
  // All is read and checked before anything changes.
  Saved read = saved();
  read.outcome = {};
  read.contact = {};
  Saved::pass(reader, read);
  std::uint64_t checksum = 0;
  reader.read(checksum);
  if (!reader.is_at_end() || read.steps < 0) {
    throw std::invalid_argument("checkpoint: damaged, it is longer than the state of its scene");
  }
  if (!is_finite_state(read.state)) {
    throw std::invalid_argument("checkpoint: damaged, a position or velocity is not a number");
  }
  if (!read.memory.change.empty() && read.memory.change.size() != state_.velocity.size()) {
    throw std::invalid_argument("checkpoint: damaged, changes of velocities have another length");
  }
  check_contacts(read.memory, contact_surfaces);
  check_points(read.points, contact_surfaces, meshes);
  for (SleepingContact& contact : read.memory.sleeping) contact.contact.key = contact.record.key;
  if (contact_) contact_->restore(read.memory);
  step_index = read.steps;
  work_ = read.work;
  substeps_ = read.substeps;
  held_steps_ = read.held_steps;
  undivided_steps_ = read.undivided_steps;
  inverted_ = -1;
  outcome_ = read.outcome;
  contact_of_step_ = read.contact;
  sums_ = std::move(read.sums);
  drive.handles() = std::move(read.handles);
  drive.overrides() = std::move(read.overrides);
  drive.delays() = std::move(read.delays);
  sleep_.set_state(std::move(read.sleep));
  sleeping_ = sleep_.is_on() ? sleep_.group_count(sleeping_links()) : 0;
  contact_points = std::move(read.points);
  record_.reset();
  set_state(read.state);
}

}  // namespace tetwarp
