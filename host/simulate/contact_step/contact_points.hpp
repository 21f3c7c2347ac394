/// @file contact_points.hpp
/// ContactPoints: where contacts are at the end of a part of a step, and what acts there.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include <tetwarp/contact_tracker.hpp>
#include <tetwarp/simulate.hpp>

#include "host/simulate/contact_step/contact_history.hpp"
#include "host/simulate/contact_step/contact_memory.hpp"
#include "host/simulate/surfaces/scene_surfaces.hpp"

namespace tetwarp {

class ContactPoints {
 public:
  /// @param surfaces  kept by the caller
  ContactPoints(const SceneSurfaces& surfaces, int threads)
      : surfaces_(surfaces), threads_(threads) {}

  /// Of a part without solved contacts.
  void clear() { solved_.clear(); }
  /// Makes the points of solved contacts, without their intensities.
  /// @param history  with contacts
  /// @param start, end  bodies at the ends of the part
  void make(const ContactHistory& history,
            const ContactSolution& solution,
            const std::vector<BodyPlace>& start,
            const std::vector<BodyPlace>& end);
  /// @param intensities  [solved contacts] at the end of the part
  void set_intensities(const std::vector<double>& intensities);
  /// Of the solved contacts, [contacts]; not after finish().
  const std::vector<ContactPoint>& solved() const { return solved_; }

  /// All points are those of the solved contacts; solved() is memory for later parts.
  void finish() { all_.swap(solved_); }
  /// All points are those of the solved contacts and of sleeping ones, in the order of keys.
  void finish_with(std::span<const SleepingContact> sleeping, const ContactHistory& history);
  /// Exchanges all points for others, which are memory for later parts.
  void swap(std::vector<ContactPoint>& points) { points.swap(all_); }

 private:
  /// @param feature  of the contact's key
  ContactPlace place_of(std::size_t body, std::int32_t feature, const MaterialPoint& point) const;

  const SceneSurfaces& surfaces_;
  int threads_;
  std::vector<ContactPoint> solved_, all_;
};

}  // namespace tetwarp
