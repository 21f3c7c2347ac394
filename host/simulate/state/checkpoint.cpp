/// @file checkpoint.cpp
/// Writes and reads checkpoints, and checks them before anything changes.
#include "host/simulate/state/checkpoint.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <stdexcept>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"
#include "host/simulate/state/checkpoint_bytes.hpp"
#include "host/simulate/step/scene_record.hpp"

namespace tetwarp {
namespace {

constexpr std::uint64_t checkpoint_kind = 0x7477'7363'0000'0000;  // "twsc", then the version
constexpr std::uint64_t checkpoint_version = checkpoint_kind + 7;

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

/// Bodies and vertices of contacts have to exist; ContactTracker checks the rest.
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

/// Bodies and surface points of contacts have to exist.
void check_points(const std::vector<ContactPoint>& points, const SimulatedScene& scene) {
  const auto check_side = [&](std::size_t body, const ContactPlace& place) {
    if (body >= scene.surfaces.surfaces.bodies.size()) refuse_contact();
    const CollisionBody& of = scene.surfaces.surfaces.bodies[body];
    const bool has_vertices = of.vertex_end > of.first_vertex;
    const std::int32_t last =
        has_vertices ? at(scene.surfaces.surface_point, of.vertex_end - 1) : -1;
    for (const std::int32_t point : place.point) {
      if (point > last) refuse_contact();
    }
  };
  for (const ContactPoint& point : points) {
    check_side(point.body_a, point.place_a);
    check_side(point.body_b, point.place_b);
  }
}

/// @param of_scene  its fingerprint
void check_head(std::span<const std::byte> bytes,
                std::uint64_t of_scene,
                CheckpointReader& reader) {
  std::uint64_t version = 0, fingerprint = 0;
  reader(version);
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
  reader(fingerprint);
  if (fingerprint != of_scene) {
    throw std::invalid_argument(
        "checkpoint: it belongs to another scene; restart the scene that wrote it, unchanged");
  }
}

template <class Stream, class List>
void pass_added(Stream& stream, List& added) {
  stream.pass_list(added, [](auto& of, auto& handle) {
    auto& [name, body, stiffness, damping, nodes, local, anchors] = handle;
    of(name, body, stiffness, damping, local);
    of.pass_list(nodes, [](auto& items, auto& node) { items(node); });
    of.pass_list(anchors, [](auto& items, auto& anchor) { items(anchor); });
  });
}

/// Reads the added handles and gives the lists of `now` their lengths.
void read_added(CheckpointReader& reader, const SimulatedScene& scene, SimulationState& now) {
  pass_added(reader, now.added);
  for (const AddedHandle& handle : now.added) {
    if (is_of_scene(scene, handle)) continue;
    throw std::invalid_argument(
        "checkpoint: damaged, or of another back end: an added handle does not fit the scene");
  }
  const std::size_t handles = scene.scene.handles.size() - scene.added.size() + now.added.size();
  now.memory.drive.handles.resize(handles);
  now.overrides.handles.resize(handles);
}

void check_end(CheckpointReader& reader, const SimulationState& state) {
  std::uint64_t checksum = 0;
  reader(checksum);
  if (!reader.is_at_end() || state.steps < 0) {
    throw std::invalid_argument("checkpoint: damaged, it is longer than the state of its scene");
  }
}

void check_numbers(const SimulationState& state) {
  if (!is_finite_state(state.bodies)) {
    throw std::invalid_argument("checkpoint: damaged, a position or velocity is not a number");
  }
  const std::vector<Point3>& change = state.memory.contacts.change;
  if (!change.empty() && change.size() != state.bodies.velocity.size()) {
    throw std::invalid_argument("checkpoint: damaged, changes of velocities have another length");
  }
}

}  // namespace

std::vector<std::byte> write_checkpoint(std::uint64_t fingerprint, const SimulationState& state) {
  CheckpointWriter writer;
  writer(checkpoint_version);
  writer(fingerprint);
  pass_added(writer, state.added);
  write_state(state, writer);
  writer(checksum_of(writer.bytes()));
  return writer.take();
}

SimulationState read_checkpoint(std::span<const std::byte> checkpoint,
                                std::uint64_t fingerprint,
                                const SimulatedScene& scene,
                                SimulationState now) {
  CheckpointReader reader(checkpoint);
  check_head(checkpoint, fingerprint, reader);
  read_added(reader, scene, now);
  now.last.outcome = {};
  now.last.contact = {};
  read_state(reader, now);
  check_end(reader, now);
  check_numbers(now);
  check_contacts(now.memory.contacts, scene.surfaces);
  check_points(now.last.points, scene);
  return now;
}

}  // namespace tetwarp
