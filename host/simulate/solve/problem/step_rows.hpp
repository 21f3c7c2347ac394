/// @file step_rows.hpp
/// StepRows: the rows of the contacts of a step that the host needs.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/contact_tracker.hpp>

#include "host/simulate/solve/problem/contact_rows.hpp"
#include "host/simulate/solve/problem/contact_sides.hpp"

namespace tetwarp {

class StepRows {
 public:
  /// @param scene, model  kept by the caller
  StepRows(const SceneSurfaces& scene, const Model& model, int threads);

  /// Begins with the contacts of a step: sets their sides. set_all() or set_for_host() must follow.
  /// @param state  at the start of the step; kept by the caller
  void begin(const ModelState& state, std::span<const TrackedContact> contacts);
  /// Sets the rows of all contacts, if they are not set yet.
  void set_all();
  /// Sets the rows of all contacts except those whose rows a device makes. Of the latter, contacts
  /// that act on prescribed blocks get rows here too: the host adds velocities and impulses of such
  /// blocks.
  /// @param on_device  numbers of contacts
  void set_for_host(std::span<const std::int32_t> on_device);

  std::span<const ContactSides> sides() const { return sides_; }
  const ContactRows& rows() const { return rows_; }

  /// J_p v_p of a contact, along its axes: J and v of prescribed blocks.
  /// @param velocity  [block_count]
  Point3 prescribed_velocity(std::size_t contact, const std::vector<Point3>& velocity) const;
  /// J^T r on prescribed blocks.
  /// @param impulse  r, [3 contacts] [N s], or forces [N]
  /// @param sums     out, [block_count]; 0 on blocks that are not prescribed
  void prescribed_impulses(std::span<const double> impulse, std::vector<Point3>& sums) const;

 private:
  bool is_prescribed(std::int32_t block) const;
  bool is_frame_prescribed(std::int32_t frame) const;
  bool has_prescribed(const ContactSide& side) const;
  void set(std::span<const std::uint8_t> takes);

  const SceneSurfaces& scene_;
  const Model& model_;
  int threads_;
  std::vector<std::int32_t> frames_;          ///< [bodies, then obstacles]
  std::vector<std::uint8_t> has_prescribed_;  ///< [vertices] moves with a prescribed block
  const ModelState* state_ = nullptr;
  std::vector<ContactSides> sides_;
  std::vector<std::uint8_t> takes_;  ///< [contacts]
  ContactRows rows_;
  bool has_all_ = false;
};

}  // namespace tetwarp
