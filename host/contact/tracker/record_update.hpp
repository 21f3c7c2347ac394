/// @file record_update.hpp
/// What happens to the record of one contact: it takes up a report, becomes a contact, its anchors
/// move.
#pragma once
#include <span>

#include <tetwarp/contact_tracker.hpp>

#include "host/contact/tracker/geometry.hpp"

namespace tetwarp {

/// Updates a record, or a new one, from its report.
/// @param report  in key order
void update_record(ContactRecord& record,
                   const ReportedContact& report,
                   std::span<const BodyPlace> places,
                   const ContactTrackerOptions& options);

/// The contact of a record at its reported points or, without a report, at its anchors.
/// @param report  or null
TrackedContact contact_of(const ContactRecord& record,
                          const ReportedContact* report,
                          std::span<const BodyPlace> places);

/// Moves anchor b by `way` [world], across `normal`. An anchor of a deformable body moves in the
/// plane of its triangle, which leaves the gap along the normal as it is; where there is no
/// triangle, anchor a moves the other way.
void move_anchor(ContactRecord& record,
                 const Eigen::Vector3d& way,
                 const Eigen::Vector3d& normal,
                 std::span<const BodyPlace> places);

/// Moves anchor b so that the tangential gap is multiplied by `keep`.
void shrink_gap(ContactRecord& record, double keep, std::span<const BodyPlace> places);

}  // namespace tetwarp
