/// @file match.hpp
/// Assigns reported contacts to the records of earlier steps.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/contact_tracker.hpp>

namespace tetwarp {

/// The reports with bodies exchanged if necessary so that a is the smaller (body, feature), sorted
/// by key.
/// @param storage  keeps them where they differ from those given
/// @throws std::invalid_argument  two have the same key
std::span<const ReportedContact> sorted_reports(std::span<const ReportedContact> reports,
                                                std::vector<ReportedContact>& storage);

/// For each report the index of its record, or -1. Equal keys match first; then reports and records
/// of the same two bodies, in the order of the distance between reported point and anchor on body
/// a, up to `match_distance` [m], if their normals differ by less than 60 degrees. At equal
/// distances smaller keys match first.
/// @param reports  of sorted_reports()
/// @param records  sorted by key
///
/// Cost: O(n log n) if few anchors of a pair of bodies are within `match_distance` of a point.
std::vector<std::int64_t> match_contacts(std::span<const ReportedContact> reports,
                                         std::span<const ContactRecord> records,
                                         std::span<const BodyPlace> places,
                                         double match_distance);

}  // namespace tetwarp
