/// @file contact_components.hpp
/// Stage "components" of the contact solver: items that stand in a common list belong together.
#pragma once
#include <cstdint>

#include "kernels/base/plain_sums.hpp"
#include "kernels/base/view.hpp"

namespace tetwarp {

/// Reads what other threads may lower meanwhile.
TETWARP_HD std::int32_t load_relaxed(const std::int32_t* value) {
#if defined(__CUDA_ARCH__)
  return *static_cast<const volatile std::int32_t*>(value);
#else
  return __atomic_load_n(value, __ATOMIC_RELAXED);
#endif
}

/// Lowers a number that any number of threads may lower: the end does not depend on their order.
TETWARP_HD void lower_to(std::int32_t* value, std::int32_t other) {
#if defined(__CUDA_ARCH__)
  atomicMin(value, other);
#else
  std::int32_t old = __atomic_load_n(value, __ATOMIC_RELAXED);
  while (other < old && !__atomic_compare_exchange_n(value, &old, other, true, __ATOMIC_RELAXED,
                                                     __ATOMIC_RELAXED)) {
  }
#endif
}

/// A forest: the parent of an item is itself or a lower one.
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

/// One index = one item, in a tree of its own.
struct PlantBody {
  View<std::int32_t> parent;
  TETWARP_HD void operator()(std::int64_t i) const { parent[i] = static_cast<std::int32_t>(i); }
};

/// One index = one list: the trees of its items go under their lowest root. Returns how many did.
struct JoinBody {
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

/// One index = one item, put right under its root.
struct FlattenBody {
  Forest forest;
  TETWARP_HD void operator()(std::int64_t i) const {
    lower_to(&forest.parent[i], forest.root_of(static_cast<std::int32_t>(i)));
  }
};

/// The lowest item of the connected component of each item.
/// @param start, item  lists, one after the other
/// @param lowest       out, [items]
///
/// Determinism: lowest items do not depend on any order. Cost: two passes over the lists, more
/// where long chains are joined by many at once.
template <class Exec>
void contact_components(Exec& exec,
                        View<const std::int64_t> start,
                        View<const std::int32_t> item,
                        View<std::int32_t> lowest) {
  constexpr const char* label = "contact/components";
  exec.for_each(label, lowest.size, PlantBody{lowest});
  const JoinBody join = {start, item, {lowest}};
  double joined = 0;
  do {
    joined = exec.template sum<PlainSums<1>>(label, 0, start.size - 1, join).value[0];
    exec.for_each(label, lowest.size, FlattenBody{{lowest}});
  } while (joined > 0);
}

}  // namespace tetwarp
