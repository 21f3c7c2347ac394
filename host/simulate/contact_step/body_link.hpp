/// @file body_link.hpp
/// BodyLink: two bodies that are in contact.
#pragma once
#include <array>
#include <cstdint>

#include <tetwarp/contact_tracker.hpp>

namespace tetwarp {

/// Two bodies or obstacles with a contact; numbered as ModelPoint::body.
using BodyLink = std::array<std::int32_t, 2>;

inline BodyLink link_of(const ContactKey& key) {
  return {key.body_a, key.body_b};
}

}  // namespace tetwarp
