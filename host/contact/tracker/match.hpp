/// @file match.hpp
/// Which of the reported contacts is which of the remembered ones.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/contact_tracker.hpp>

namespace tetwarp {

/// The same contact with the smaller (body, feature) as a.
ReportedContact in_key_order(const ReportedContact& report);

/// For each report the index of its record, or -1: by key, then pairs of the same two bodies by
/// growing distance between the reported point and the anchor on body a, up to `match_distance`;
/// ties go to the smaller keys.
/// @param reports  in key order, sorted by key
/// @param records  sorted by key
std::vector<std::int64_t> match_contacts(std::span<const ReportedContact> reports,
                                         std::span<const ContactRecord> records,
                                         std::span<const BodyPose> poses,
                                         double match_distance);

}  // namespace tetwarp
