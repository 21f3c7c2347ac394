/// @file input_checks.hpp
/// Checks of what the tracker is given. All throw std::invalid_argument with one line that names
/// the contact, body or material; of a contact ContactKeyError.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/contact_tracker.hpp>

namespace tetwarp {

/// Throws std::invalid_argument: "ContactTracker: SUBJECT PROBLEM".
[[noreturn]] void refuse(const std::string& subject, const std::string& problem);
/// The same of a contact.
[[noreturn]] void refuse(const ContactKey& key, const std::string& problem);

std::string name_of(const ContactKey& key);

void check_materials(const std::vector<ContactMaterial>& materials);

void check_report(const ReportedContact& report,
                  std::span<const BodyPlace> places,
                  std::size_t material_count);

void check_records(const std::vector<ContactRecord>& records, std::size_t material_count);

/// The bodies of a record exist, and have the vertices of its material points.
void check_record_bodies(const ContactRecord& record, std::span<const BodyPlace> places);

/// Positions are finite, rotations of length 1 within 1e-6. Any number of threads: same error.
void check_places(std::span<const BodyPlace> places, int threads);

/// Three finite impulses and velocities for each contact.
/// @param pressing  one finite number for each contact, or empty
void check_solution(const ContactSolution& solution,
                    const std::vector<TrackedContact>& contacts,
                    std::span<const double> pressing);

}  // namespace tetwarp
