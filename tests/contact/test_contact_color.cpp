/// @file test_contact_color.cpp
/// Contacts of one color share no body, and colors are the lowest free ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <random>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "host/contact/structure/color.hpp"
#include "host/contact/structure/islands.hpp"
#include "host/exec/exec_cpu.hpp"
#include "kernels/contact/contact_components.hpp"
#include "tests/support/contact/contact_samples.hpp"
#include "tests/support/contact/contact_stages.hpp"

namespace tetwarp::test {
namespace {
using Colors = std::vector<std::int32_t>;

/// By search: the lowest color that no earlier contact of the groups has.
Colors searched_colors(const Lists& groups, std::int64_t group_count) {
  const Lists members = make_transposed(groups, group_count);
  Colors colors;
  for (std::int32_t c = 0; c < groups.size(); ++c) {
    std::set<std::int32_t> taken;
    for (const std::int32_t group : groups.of(c)) {
      for (const std::int32_t neighbor : members.of(group)) {
        if (neighbor < c) taken.insert(colors[static_cast<std::size_t>(neighbor)]);
      }
    }
    std::int32_t color = 0;
    while (taken.contains(color)) ++color;
    colors.push_back(color);
  }
  return colors;
}

Colors colors_of(const Lists& groups, std::int64_t group_count) {
  return color_contacts(groups, group_count).of_contact;
}

/// Contacts of two bodies, or of one body with the fixed world.
Lists random_groups(std::uint32_t seed, std::int64_t contacts, std::int32_t bodies) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::int32_t> body(0, bodies - 1);
  Lists groups;
  for (std::int64_t c = 0; c < contacts; ++c) {
    std::set<std::int32_t> touched = {body(random), body(random)};
    groups.item.insert(groups.item.end(), touched.begin(), touched.end());
    groups.close_list();
  }
  return groups;
}

constexpr std::int64_t sizes[] = {0, 1, 31, 32, 33, 1025};

TEST(ContactColor, NoTwoContactsOfAColorShareAGroupAndColorsLeaveNoHole) {
  for (const std::int64_t size : sizes) {
    const Lists groups = random_groups(51, size, 40);
    const Colors colors = colors_of(groups, 40);

    std::set<std::pair<std::int32_t, std::int32_t>> taken;
    for (std::int64_t c = 0; c < size; ++c) {
      const std::int32_t color = colors[static_cast<std::size_t>(c)];
      std::set<std::int32_t> lower;
      for (const std::int32_t group : groups.of(c)) {
        EXPECT_TRUE(taken.emplace(group, color).second) << "contact " << c << ", size " << size;
        for (std::int32_t other = 0; other < color; ++other) {
          if (taken.contains({group, other})) lower.insert(other);
        }
      }
      EXPECT_EQ(static_cast<std::int32_t>(lower.size()), color) << "contact " << c;
    }
  }
}

/// Groups of up to 64 contacts and larger ones, whose colors are stored in other ways.
TEST(ContactColor, AreTheLowestFreeOnesInTheOrderOfContacts) {
  for (const std::int64_t size : sizes) {
    for (const std::int32_t bodies : {2, 40, 500}) {
      const Lists groups = random_groups(52, size, bodies);
      EXPECT_EQ(colors_of(groups, bodies), searched_colors(groups, bodies)) << size << " contacts";
    }
  }
}

TEST(ContactColor, AChainTakesTwoColorsInTurn) {
  Lists groups;  // contact c between bodies c and c + 1
  for (std::int32_t c = 0; c < 5; ++c) {
    groups.item.insert(groups.item.end(), {c, c + 1});
    groups.close_list();
  }

  EXPECT_EQ(colors_of(groups, 6), (Colors{0, 1, 0, 1, 0}));
}

TEST(ContactColor, ContactsThatMoveNothingTogetherAreAllOfOneColor) {
  Lists groups;
  for (std::int32_t c = 0; c < 33; ++c) {
    if (c % 3 > 0) groups.item.push_back(c);  // every third contact has no group at all
    groups.close_list();
  }

  EXPECT_EQ(colors_of(groups, 33), Colors(33, 0));
}

/// More colors than bits in a word, in a number of steps proportional to the contacts.
TEST(ContactColor, EveryContactOfOneBodyHasAColorOfItsOwn) {
  for (const std::int32_t size : {64, 65, 150, 64000}) {
    Lists groups;
    Colors expected;
    for (std::int32_t c = 0; c < size; ++c) {
      groups.item.push_back(0);
      groups.close_list();
      expected.push_back(c);
    }

    const ContactColors colors = color_contacts(groups, 1);

    EXPECT_EQ(colors.of_contact, expected);
    EXPECT_LE(colors.steps, std::max(size, 64 * 64)) << size << " contacts";
  }
}

/// The spheres of a tray also touch each other.
TEST(ContactColor, StepsGrowWithTheContactsOfATray) {
  for (const std::int64_t edge : {16, 128}) {
    Lists groups;
    for (std::int32_t sphere = 1; sphere <= edge * edge; ++sphere) {
      groups.item.insert(groups.item.end(), {0, sphere});
      groups.close_list();
      for (const std::int64_t step : {std::int64_t{1}, edge}) {
        if (sphere <= step) continue;
        groups.item.insert(groups.item.end(), {sphere - static_cast<std::int32_t>(step), sphere});
        groups.close_list();
      }
    }

    const ContactColors colors = color_contacts(groups, edge * edge + 1);

    EXPECT_LE(colors.steps, 12 * groups.size()) << edge << " spheres along each edge";
    if (edge > 16) continue;
    EXPECT_EQ(colors.of_contact, searched_colors(groups, edge * edge + 1));
  }
}

TEST(ContactColor, ContactsAreSortedByIslandThenColorThenIndex) {
  const Lists groups = random_groups(53, 60, 90);
  const Colors colors = colors_of(groups, 90);
  HostStages stages;
  const std::vector<std::int32_t> islands = components_of(make_transposed(groups, 90), 60, stages);

  const ContactOrder order = make_contact_order(groups, islands);

  std::vector<std::tuple<std::int32_t, std::int32_t, std::int32_t>> expected;
  for (std::int32_t c = 0; c < 60; ++c) {
    const auto i = static_cast<std::size_t>(c);
    expected.emplace_back(islands[i], colors[i], c);
  }
  std::sort(expected.begin(), expected.end());
  ASSERT_GT(std::get<0>(expected.back()), 5);  // many islands
  std::map<std::int32_t, std::vector<std::int64_t>> color_start;
  for (std::size_t slot = 0; slot < expected.size(); ++slot) {
    const auto& [island, color, contact] = expected[slot];
    EXPECT_EQ(order.contact_of_slot[slot], contact);
    std::vector<std::int64_t>& start = color_start[island];
    if (static_cast<std::int32_t>(start.size()) == color) {
      start.push_back(static_cast<std::int64_t>(slot));
    }
  }
  std::vector<std::int64_t> starts;
  for (const auto& [island, start] : color_start) {
    if (island > 0) starts.push_back(start.front());
    EXPECT_EQ(order.island_colors[static_cast<std::size_t>(island)],
              static_cast<std::int64_t>(starts.size()));
    starts.insert(starts.end(), start.begin(), start.end());
  }
  starts.push_back(60);
  EXPECT_EQ(order.color_start, starts);
}

/// Ten bodies on one floor: the floor has no dofs and causes no conflict, the links between the
/// bodies do.
TEST(ContactColor, BodiesOnOneFloorDoNotConflict) {
  std::mt19937 random(54);
  const ContactProblem problem = samples::random_global(random, 10, 6, 0, 0.3);

  const ContactStages stages(problem);

  const std::vector<std::int32_t>& slots = stages.structure.contact_of_slot;
  ASSERT_GE(stages.colors().size, 3);
  EXPECT_EQ(stages.colors()[1], 10);
  for (std::int32_t c = 0; c < 10; ++c) EXPECT_EQ(slots[static_cast<std::size_t>(c)], c);
}

/// By breadth-first search.
std::vector<std::int32_t> searched_components(const Lists& lists, std::int64_t items) {
  const Lists of_item = make_transposed(lists, items);
  std::vector<std::int32_t> lowest(static_cast<std::size_t>(items), -1);
  for (std::int32_t seed = 0; seed < items; ++seed) {
    std::vector<std::int32_t> open = {seed};
    while (!open.empty()) {
      const std::int32_t item = open.back();
      open.pop_back();
      if (lowest[static_cast<std::size_t>(item)] >= 0) continue;
      lowest[static_cast<std::size_t>(item)] = seed;
      for (const std::int32_t list : of_item.of(item)) {
        for (const std::int32_t other : lists.of(list)) open.push_back(other);
      }
    }
  }
  return lowest;
}

TEST(ContactComponents, AreThoseOfASearchInAnyOrder) {
  for (const std::int64_t size : sizes) {
    const Lists lists = random_groups(53, size, 700);
    const std::vector<std::int32_t> expected = searched_components(lists, 700);
    EXPECT_EQ(HostStages().lowest_connected(lists, 700), expected) << size << " lists";
    CpuExec in_order(1), in_parallel(3);
    ReversedExec reversed;
    const auto expect_found = [&](auto& exec) {
      std::vector<std::int32_t> lowest(700);
      contact_components(exec, view_of(lists.start), view_of(lists.item), view_of(lowest));
      EXPECT_EQ(lowest, expected) << size << " lists";
    };
    expect_found(in_order);
    expect_found(in_parallel);
    expect_found(reversed);
  }
}

/// The worst case: a chain whose lists are united from its far end.
TEST(ContactComponents, AChainIsOne) {
  Lists lists;
  for (std::int32_t i = 2000; i-- > 0;) {
    lists.item.insert(lists.item.end(), {i, i + 1});
    lists.close_list();
  }
  std::vector<std::int32_t> lowest(2001);
  ReversedExec exec;

  contact_components(exec, view_of(lists.start), view_of(lists.item), view_of(lowest));

  EXPECT_EQ(lowest, std::vector<std::int32_t>(2001, 0));
}
}  // namespace
}  // namespace tetwarp::test
