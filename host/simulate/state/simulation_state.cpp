/// @file simulation_state.cpp
/// The members of a state in the order of a checkpoint.
#include "host/simulate/state/simulation_state.hpp"

namespace tetwarp {
namespace {

// Each of these functions writes with a CheckpointWriter and reads with a CheckpointReader.
// Structured bindings name all members of a record: with a new one this file does not compile until
// it is decided whether a checkpoint holds that.

template <class Stream, class Point>
void pass_material_point(Stream& stream, Point& point) {
  auto& [local, vertex, weight] = point;
  stream(local, vertex, weight);
}

template <class Stream, class Record>
void pass_record(Stream& stream, Record& record) {
  auto& [key, material, has_touched, area, intensity, anchor_a, anchor_b, normal_a, normal_b,
         impulse_world, material_a, material_b, standoff, normal_world] = record;
  stream(key, material, has_touched, area, intensity, anchor_a, anchor_b, normal_a, normal_b,
         impulse_world);
  pass_material_point(stream, material_a);
  pass_material_point(stream, material_b);
  stream(standoff, normal_world);
}

template <class Stream, class Point>
void pass_point(Stream& stream, Point& point) {
  auto& [body_a, body_b, position, normal, impulse, gap, area, intensity, place_a, place_b] = point;
  stream(body_a, body_b, position, normal, impulse, gap, area, intensity);
  for (auto* place : {&place_a, &place_b}) {
    auto& [of_surface, weight] = *place;
    stream(of_surface, weight);
  }
}

/// The key is that of the record, and members that only a solve reads are left out.
template <class Stream, class Contact>
void pass_tracked(Stream& stream, Contact& contact) {
  auto& [key, point_a_world, point_b_world, material_a, material_b, axes, gap, is_reported,
         surface_velocity, obstacle_velocity, rebound_speed] = contact;
  stream(point_a_world, point_b_world);
  pass_material_point(stream, material_a);
  pass_material_point(stream, material_b);
  stream(axes);
}

template <class Stream, class Sleeping>
void pass_sleeping(Stream& stream, Sleeping& sleeping) {
  auto& [record, contact, point, time_step] = sleeping;
  pass_record(stream, record);
  pass_point(stream, point);
  stream(time_step);
  pass_tracked(stream, contact);
}

/// Without work that was skipped and seconds.
template <class Stream, class Outcome>
void pass_outcome(Stream& stream, Outcome& outcome) {
  auto& [completed, converged, linear_iterations, linear_residual, skipped_rotations,
         skipped_blocks, seconds] = outcome;
  stream(linear_iterations, linear_residual, converged);
}

/// Without what only a step that goes on reads.
template <class Stream, class Part>
void pass_part(Stream& stream, Part& part) {
  auto& [is_completed, woken, converged, residual, contacts, islands, passes, sweeps,
         outer_iterations, clamped_islands, stalled_scripts, smallest_fraction, seconds] = part;
  stream(converged, residual, contacts, islands, passes, sweeps, outer_iterations, clamped_islands,
         stalled_scripts);
}

/// The work is part of that of all steps.
template <class Stream, class Sums>
void pass_sums(Stream& stream, Sums& sums) {
  auto& [support, handle, coupling, load, contact, obstacle, on_a, work] = sums;
  stream(support, handle, coupling, load, contact, obstacle, on_a);
}

template <class Stream, class State>
void pass_bodies(Stream& stream, State& bodies) {
  auto& [position, rotation, velocity, angular_momentum] = bodies;
  stream(position, rotation, velocity, angular_momentum);
}

template <class Stream, class Memory>
void pass_contacts(Stream& stream, Memory& contacts) {
  auto& [time_step, records, change, sleeping] = contacts;
  stream(time_step);
  stream.pass_list(records, [](auto& of, auto& record) { pass_record(of, record); });
  stream.pass_list(change, [](auto& of, auto& velocity) { of(velocity); });
  stream.pass_list(sleeping, [](auto& of, auto& contact) { pass_sleeping(of, contact); });
}

template <class Stream, class State>
void pass_state(Stream& stream, State& state) {
  auto& [steps, division, last, bodies, memory, overrides, added] = state;
  auto& [held_steps, undivided_steps] = division;
  auto& [outcome, contact, sums, substeps, is_out_of_time, points, work] = last;
  auto& [drive, contacts, sleep] = memory;
  auto& [handles, delays] = drive;
  auto& [moved_handles, moved_scripts] = overrides;
  auto& [is_asleep, calm_time, inputs] = sleep;
  stream(steps, work, substeps, is_out_of_time, held_steps, undivided_steps);
  pass_outcome(stream, outcome);
  pass_part(stream, contact);
  pass_bodies(stream, bodies);
  pass_sums(stream, sums);
  for (auto& handle : handles) stream(handle);
  for (auto& handle : moved_handles) stream(handle);
  for (auto& script : moved_scripts) stream(script);
  stream(delays);
  pass_contacts(stream, contacts);
  stream(is_asleep, calm_time, inputs);
  stream.pass_list(points, [](auto& of, auto& point) { pass_point(of, point); });
}

}  // namespace

void write_state(const SimulationState& state, CheckpointWriter& writer) {
  pass_state(writer, state);
}

void read_state(CheckpointReader& reader, SimulationState& state) {
  pass_state(reader, state);
  for (SleepingContact& sleeping : state.memory.contacts.sleeping) {
    sleeping.contact.key = sleeping.record.key;
  }
}

}  // namespace tetwarp
