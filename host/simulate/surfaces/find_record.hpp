/// @file find_record.hpp
/// Finds the record of a contact by its key.
#pragma once
#include <algorithm>
#include <span>

#include <tetwarp/contact_tracker.hpp>

namespace tetwarp {

/// @param records  sorted by key
/// @returns null where there is none
inline const ContactRecord* find_record(std::span<const ContactRecord> records,
                                        const ContactKey& key) {
  const auto found = std::ranges::lower_bound(records, key, {}, &ContactRecord::key);
  return found != records.end() && found->key == key ? &*found : nullptr;
}

}  // namespace tetwarp
