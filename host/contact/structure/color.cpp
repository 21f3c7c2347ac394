/// @file color.cpp
/// Gives contacts, in their order, the lowest color that is free in all their groups.
#include "host/contact/structure/color.hpp"

#include <algorithm>
#include <bit>
#include <unordered_map>

#include "host/base/index_of.hpp"
#include "host/base/vector_view.hpp"

namespace tetwarp {
namespace {
constexpr std::int64_t word_bits = 64;

/// The colors taken in groups of many contacts, one bit each. Only words with a bit set are stored,
/// so that memory is proportional to the contacts of these groups.
class LargeGroups {
 public:
  LargeGroups(const Lists& members, std::int64_t smallest) : first_open_(index_of(members.size())) {
    for (std::int64_t g = 0; g < members.size(); ++g) {
      const auto size = static_cast<std::int64_t>(members.of(g).size());
      first_open_[index_of(g)] = size < smallest ? -1 : 0;
    }
  }

  bool contains(std::int32_t group) const { return first_open_[index_of(group)] >= 0; }

  /// The first word that is not full.
  std::int64_t first_open(std::int32_t group) const { return first_open_[index_of(group)]; }

  std::uint64_t word(std::int32_t group, std::int64_t word) const {
    const auto found = words_.find(key_of(group, word));
    return found == words_.end() ? 0 : found->second;
  }

  void take(std::int32_t group, std::int32_t color) {
    words_[key_of(group, color / word_bits)] |= std::uint64_t{1} << (color % word_bits);
    std::int64_t& open = first_open_[index_of(group)];
    while (~word(group, open) == 0) ++open;
  }

 private:
  static std::uint64_t key_of(std::int32_t group, std::int64_t word) {
    return (static_cast<std::uint64_t>(group) << 32) + static_cast<std::uint64_t>(word);
  }

  std::vector<std::int64_t> first_open_;  ///< -1: not a large group
  std::unordered_map<std::uint64_t, std::uint64_t> words_;
};
}  // namespace

ContactColors color_contacts(const Lists& groups, std::int64_t group_count) {
  const Lists members = make_transposed(groups, group_count);
  LargeGroups large(members, word_bits + 1);
  ContactColors colors;
  colors.of_contact.resize(index_of(groups.size()));
  std::vector<std::uint64_t>
      near;  // colors of the neighbors in small groups; zero between contacts
  for (std::int64_t c = 0; c < groups.size(); ++c) {
    const auto for_each_near_color = [&](const auto& visit) {
      for (const std::int32_t group : groups.of(c)) {
        if (large.contains(group)) continue;
        for (const std::int32_t neighbor : members.of(group)) {
          if (neighbor >= c) break;
          visit(colors.of_contact[index_of(neighbor)]);
        }
      }
    };
    for_each_near_color([&](std::int32_t color) {
      const std::size_t word = index_of(color / word_bits);
      if (word >= near.size()) near.resize(word + 1);
      near[word] |= std::uint64_t{1} << (color % word_bits);
      ++colors.steps;
    });

    std::int64_t word = 0;
    for (const std::int32_t group : groups.of(c)) {
      if (large.contains(group)) word = std::max(word, large.first_open(group));
    }
    std::uint64_t taken = 0;
    for (;; ++word) {
      ++colors.steps;
      taken = index_of(word) < near.size() ? near[index_of(word)] : 0;
      for (const std::int32_t group : groups.of(c)) {
        if (large.contains(group)) taken |= large.word(group, word);
      }
      if (~taken != 0) break;
    }
    const auto color = static_cast<std::int32_t>(word_bits * word + std::countr_one(taken));
    colors.of_contact[index_of(c)] = color;
    for (const std::int32_t group : groups.of(c)) {
      if (large.contains(group)) large.take(group, color);
    }
    for_each_near_color(
        [&](std::int32_t near_color) { near[index_of(near_color / word_bits)] = 0; });
  }
  return colors;
}

}  // namespace tetwarp
