/// @file grid_plan.cpp
/// The sizes of grids of least estimated work, and how their cells are numbered.
#include "host/collide/grid_plan.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace tetwarp {
namespace {
constexpr double cells_per_box = 1 / 1.3;  // extent of a mean box over the edge of a cell
constexpr double most_cells = 8;           // along an axis of the largest box of a grid
constexpr double linear_cells = 0x1p22;    // numbers of cells are hashed if there are more

/// Boxes of one size.
struct SizeClass {
  int size;
  double extent;  ///< mean [m]
  double count;
};

double mean_extent(const SizeClass* first, const SizeClass* past) {
  double sum = 0, count = 0;
  for (const SizeClass* c = first; c != past; ++c) {
    sum += c->count * c->extent;
    count += c->count;
  }
  return sum / count;
}

/// Estimated time of a grid for the classes [first, past), ascending, in box tests. Boxes lie on
/// surfaces: a cell of edge c holds about (c / extent)^2 of them.
double work_of(const SizeClass* first, const SizeClass* past, double finer_items) {
  constexpr double entry = 6;        // making and sorting an entry, in box tests
  constexpr double finer_cells = 2;  // entries of a smaller box in this grid
  const double cell = mean_extent(first, past) / cells_per_box;
  if (past[-1].extent > most_cells * cell && past - first > 1) {
    return std::numeric_limits<double>::infinity();
  }
  double work = entry * finer_cells * finer_items;
  for (const SizeClass* c = first; c != past; ++c) {
    const double cells = c->extent / cell;
    work += c->count * entry * (1 + cells) * (1 + cells) * (1 + cells / 2);
    work += c->count * std::min(c->count, 2 / (cells * cells));
  }
  return work;
}

using ClassNumbers = std::array<std::size_t, item_sizes + 1>;

/// Dynamic programming over the last grid.
/// @returns  for each class the first one of its grid, where it is the last one of a grid; entry
///           `past` is for class past - 1
ClassNumbers best_grids(const SizeClass* classes, std::size_t count) {
  std::array<double, item_sizes + 1> finer{}, least{};
  ClassNumbers first{};
  for (std::size_t past = 1; past <= count; ++past) {
    finer[past] = finer[past - 1] + classes[past - 1].count;
    least[past] = std::numeric_limits<double>::infinity();
    for (std::size_t begin = 0; begin < past; ++begin) {
      const double work = least[begin] + work_of(classes + begin, classes + past, finer[begin]);
      if (!(work < least[past])) continue;
      least[past] = work;
      first[past] = begin;
    }
  }
  return first;
}

/// Sets how cells are numbered: consecutively where all grids together have few cells; else the
/// coordinates of a cell are hashed to 8 to 16 times as many numbers as there are items.
void set_keys(GridPlan& plan, const Box& space, double items) {
  double total = 0;
  for (int l = 0; l < plan.level_count; ++l) {
    GridLevel& level = plan.levels[l];
    double cells = 1;
    level.first_cell = total < linear_cells ? static_cast<std::uint32_t>(total) : 0;
    for (int k = 0; k < 3; ++k) {
      level.stride[k] = cells < linear_cells ? static_cast<std::uint32_t>(cells) : 0;
      cells *= 1 + std::floor((space.high[k] - space.low[k]) * level.per_cell);
    }
    total += cells;
  }
  if (total <= linear_cells) {
    plan.key_shift = 0;
    plan.key_bits =
        std::max(1, static_cast<int>(std::bit_width(static_cast<std::uint32_t>(total))));
    return;
  }
  const int bits = static_cast<int>(std::ceil(std::log2(std::max(items, 1.0)))) + 3;
  plan.key_bits = std::clamp(bits, 11, 26);
  plan.key_shift = 32 - plan.key_bits;
  for (int l = 0; l < plan.level_count; ++l) {
    GridLevel& level = plan.levels[l];
    level.first_cell = 0x9e3779b9u * static_cast<std::uint32_t>(l);
    level.stride[0] = 0x8da6b343u;
    level.stride[1] = 0xd8163841u;
    level.stride[2] = 0xcb1ab31fu;
  }
}
}  // namespace

GridPlan make_grid_plan(const std::array<std::int64_t, item_sizes>& counts,
                        int largest,
                        const Box& space) {
  constexpr double mean_of_class = 1.44;  // of sizes spread evenly in the logarithm
  std::array<SizeClass, item_sizes> classes;
  std::size_t class_count = 0;
  double items = 0;
  for (int s = item_sizes - 1; s >= 0; --s) {
    const auto count = static_cast<double>(counts[static_cast<std::size_t>(s)]);
    if (count > 0) classes[class_count++] = {s, std::ldexp(mean_of_class, largest - s), count};
    items += count;
  }
  const ClassNumbers first = best_grids(classes.data(), class_count);
  GridPlan plan{};
  std::copy_n(space.low, 3, plan.origin);
  for (std::size_t past = class_count; past > 0; past = first[past]) ++plan.level_count;
  std::int32_t l = plan.level_count;
  for (std::size_t past = class_count; past > 0; past = first[past]) {
    --l;
    const std::size_t begin = first[past];
    plan.levels[l].per_cell =
        cells_per_box / mean_extent(classes.data() + begin, classes.data() + past);
    for (std::size_t c = begin; c < past; ++c) {
      plan.level_of_size[classes[c].size] = static_cast<std::uint8_t>(l);
    }
  }
  set_keys(plan, space, items);
  return plan;
}

}  // namespace tetwarp
