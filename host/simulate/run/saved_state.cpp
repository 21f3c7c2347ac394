/// @file saved_state.cpp
/// Takes and restores what a checkpoint holds.
#include "host/simulate/run/saved_state.hpp"

namespace tetwarp {
namespace {

// Each of these functions writes with a CheckpointWriter and reads with a CheckpointReader.

template <class Stream, class Point>
void pass_material_point(Stream& stream, Point& point) {
  stream(point.local);
  stream(point.vertex);
  stream(point.weight);
}

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
  pass_material_point(stream, record.material_a);
  pass_material_point(stream, record.material_b);
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
  stream(sleeping.contact.point_a_world);
  stream(sleeping.contact.point_b_world);
  pass_material_point(stream, sleeping.contact.material_a);
  pass_material_point(stream, sleeping.contact.material_b);
  stream(sleeping.contact.axes);
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

template <class Stream, class Memory>
void pass_memory(Stream& stream, Memory& memory) {
  stream(memory.time_step);
  stream.pass_list(memory.records, [](auto& of, auto& record) { pass_record(of, record); });
  stream.pass_list(memory.change, [](auto& of, auto& change) { of(change); });
  stream.pass_list(memory.sleeping, [](auto& of, auto& contact) { pass_sleeping(of, contact); });
}

template <class Stream, class Saved>
void pass_saved(Stream& stream, Saved& saved) {
  stream(saved.steps);
  stream(saved.last.work);
  stream(saved.last.substeps);
  stream(saved.held_steps);
  stream(saved.undivided_steps);
  stream(saved.last.outcome.linear_iterations);
  stream(saved.last.outcome.linear_residual);
  stream(saved.last.outcome.converged);
  pass_part(stream, saved.last.contact);
  pass_state(stream, saved.state);
  pass_sums(stream, saved.last.sums);
  for (auto& handle : saved.handles) stream(handle);
  for (auto& handle : saved.overrides.handles) stream(handle);
  for (auto& script : saved.overrides.scripts) stream(script);
  stream(saved.delays);
  pass_memory(stream, saved.memory);
  stream(saved.sleep.is_asleep);
  stream(saved.sleep.calm_time);
  stream(saved.sleep.inputs);
  stream.pass_list(saved.last.points, [](auto& of, auto& point) { pass_point(of, point); });
}

}  // namespace

void write_state(const SavedState& saved, CheckpointWriter& writer) {
  pass_saved(writer, saved);
}

void read_state(CheckpointReader& reader, SavedState& saved) {
  pass_saved(reader, saved);
  for (SleepingContact& sleeping : saved.memory.sleeping) {
    sleeping.contact.key = sleeping.record.key;
  }
}

}  // namespace tetwarp
