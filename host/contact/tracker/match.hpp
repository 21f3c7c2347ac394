/// @file match.hpp
/// Assigns reported contacts to the records of earlier steps.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/contact_tracker.hpp>

namespace tetwarp {

/// The same contact, with bodies exchanged if necessary so that a is the smaller (body, feature).
ReportedContact in_key_order(const ReportedContact& report);

/// For each report the index of its record, or -1. Equal keys match first; then reports and records
/// of the same two bodies, in the order of the distance between reported point and anchor on body
/// a, up to `match_distance` [m]. At equal distances smaller keys match first.
/// @param reports  each from in_key_order(), sorted by key
/// @param records  sorted by key
std::vector<std::int64_t> match_contacts(std::span<const ReportedContact> reports,
                                         std::span<const ContactRecord> records,
                                         std::span<const BodyPose> poses,
                                         double match_distance);

}  // namespace tetwarp
