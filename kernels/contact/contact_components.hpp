/// @file contact_components.hpp
/// Stage "components" of the contact solver on a device: connected components of items that share
/// lists, by union-find in any order of threads. On the host DisjointSets finds them.
#pragma once
#include <cstdint>

#include "kernels/base/lower_to.hpp"
#include "kernels/base/plain_sums.hpp"
#include "kernels/base/view.hpp"

namespace tetwarp {

/// Reads a value that other threads may lower at that time.
TETWARP_HD std::int32_t load_relaxed(const std::int32_t* value) {
#if defined(__CUDA_ARCH__)
  return *static_cast<const volatile std::int32_t*>(value);
#else
  return __atomic_load_n(value, __ATOMIC_RELAXED);
#endif
}

/// The union-find forest: the parent of an item is itself (a root) or a lower item.
struct Forest {
  View<std::int32_t> parent;

  TETWARP_HD std::int32_t root_of(std::int32_t item) const {
    for (;;) {
      const std::int32_t parent_item = load_relaxed(&parent[item]);
      if (parent_item == item) return item;
      item = parent_item;
    }
  }
};

/// One index = one item: makes it a separate tree.
struct MakeTreeOp {
  View<std::int32_t> parent;
  TETWARP_HD void operator()(std::int64_t i) const { parent[i] = static_cast<std::int32_t>(i); }
};

/// One index = one list: puts the trees of its items under their lowest root. Returns how many
/// trees were moved.
struct UniteOp {
  View<const std::int64_t> start;
  View<const std::int32_t> item;
  Forest forest;

  TETWARP_HD PlainSums<1> operator()(std::int64_t list) const {
    PlainSums<1> joined;
    if (start[list] == start[list + 1]) return joined;
    std::int32_t lowest = forest.root_of(item[start[list]]);
    for (std::int64_t k = start[list] + 1; k < start[list + 1]; ++k) {
      lowest = min_of(lowest, forest.root_of(item[k]));
    }
    for (std::int64_t k = start[list]; k < start[list + 1]; ++k) {
      const std::int32_t root = forest.root_of(item[k]);
      if (root <= lowest) continue;
      lower_to(&forest.parent[root], lowest);
      joined.value[0] += 1;
    }
    return joined;
  }
};

/// One index = one item: puts it directly under its root.
struct CompressOp {
  Forest forest;
  TETWARP_HD void operator()(std::int64_t i) const {
    lower_to(&forest.parent[i], forest.root_of(static_cast<std::int32_t>(i)));
  }
};

/// Finds the lowest item of the connected component of each item.
/// @param exec    where to run
/// @param start   first entry of each list, and the end, [lists + 1]
/// @param item    entries of all lists
/// @param lowest  out, [items]
///
/// Determinism: the result does not depend on the order of execution. Cost: two passes over the
/// lists; more if threads unite long chains at the same time.
template <class Exec>
void contact_components(Exec& exec,
                        View<const std::int64_t> start,
                        View<const std::int32_t> item,
                        View<std::int32_t> lowest) {
  constexpr const char* label = "contact/components";
  exec.for_each(label, lowest.size, MakeTreeOp{lowest});
  const UniteOp join = {start, item, {lowest}};
  double joined = 0;
  do {
    joined = exec.template sum<PlainSums<1>>(label, 0, start.size - 1, join).value[0];
    exec.for_each(label, lowest.size, CompressOp{{lowest}});
  } while (joined > 0);
}

}  // namespace tetwarp
