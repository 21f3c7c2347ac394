/// @file test_contact_color.cpp
/// Contacts of one color share no body, and the colors do not depend on the order of threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <random>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "host/contact/structure/islands.hpp"
#include "host/exec/contact_exec_cpu.hpp"
#include "kernels/contact/contact_color.hpp"
#include "kernels/contact/contact_components.hpp"
#include "tests/scenes/contact_samples.hpp"
#include "tests/scenes/contact_stages.hpp"

namespace tetwarp::test {
namespace {
using Colors = std::vector<std::int32_t>;

/// Counts the passes of another executor.
template <class Exec>
struct Counting {
  Exec exec;
  int passes = 0;

  template <class Body>
  void for_each(const char* label, std::int64_t count, const Body& body) {
    ++passes;
    exec.for_each(label, count, body);
  }
  template <class Sum, class Body>
  Sum sum(const char* label, std::int64_t first, std::int64_t last, const Body& body) {
    return exec.template sum<Sum>(label, first, last, body);
  }
};

/// @param rounds  out: passes over the contacts, without the one that prepares them
template <class Exec>
Colors colors_of(const Exec& exec, const Lists& groups, std::int64_t group_count, int& rounds) {
  const Lists members = make_transposed(groups, group_count);
  Colors colors(static_cast<std::size_t>(groups.size()));
  Counting<Exec> counting{exec};
  contact_color(counting,
                ContactGroups{view_of(groups.start), view_of(groups.item), view_of(members.start),
                              view_of(members.item)},
                view_of(colors));
  rounds = counting.passes - 1;
  return colors;
}

Colors colors_of(const Lists& groups, std::int64_t group_count) {
  int rounds = 0;
  Colors colors = colors_of(CpuContactExec(1), groups, group_count, rounds);
  EXPECT_EQ(rounds, 1);
  return colors;
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

TEST(ContactColor, AnyOrderOfVisitsEndsAtTheSameColors) {
  for (const std::int64_t size : sizes) {
    const Lists groups = random_groups(52, size, 40);
    int rounds = 0;

    EXPECT_EQ(colors_of(ReversedExec{}, groups, 40, rounds), colors_of(groups, 40));
    EXPECT_TRUE(size <= 1 || rounds > 1);
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

/// More colors than bits in a word.
TEST(ContactColor, EveryContactOfOneBodyHasAColorOfItsOwn) {
  Lists groups;
  for (std::int32_t c = 0; c < 150; ++c) {
    groups.item.push_back(0);
    groups.close_list();
  }

  const Colors colors = colors_of(groups, 1);

  for (std::size_t c = 0; c < colors.size(); ++c) {
    EXPECT_EQ(colors[c], static_cast<std::int32_t>(c));
  }
}

TEST(ContactColor, ContactsAreSortedByIslandThenColorThenIndex) {
  const Lists groups = random_groups(53, 60, 90);
  const Colors colors = colors_of(groups, 90);
  HostStages stages;
  const std::vector<std::int32_t> islands = components_of(make_transposed(groups, 90), 60, stages);

  const ContactOrder order = make_contact_order(groups, islands, stages);

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
    CpuContactExec in_order(1), in_parallel(3);
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
