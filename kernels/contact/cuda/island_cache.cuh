/// @file island_cache.cuh
/// Copies of an island's unknowns and constants in shared memory, as many as fit.
#pragma once
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "kernels/contact/contact_indices.hpp"
#include "kernels/contact/contact_numbers.hpp"
#include "kernels/exec/launch.hpp"

namespace tetwarp {

/// The parts of the arrays of a problem that belong to one island, as index ranges.
struct IslandArrays {
  std::int64_t pair_begin = 0, pair_end = 0;    ///< of contacts, or entries of W
  std::int64_t value_begin = 0, value_end = 0;  ///< numbers of J
  std::int64_t link_begin = 0, link_end = 0;    ///< pairs by block
};

/// The ranges of an island.
/// @param indices  in memory that the caller reads
inline IslandArrays island_arrays(const ContactIndices& indices, const ContactIsland& island) {
  IslandArrays arrays;
  if (indices.is_local) {
    arrays.pair_begin = indices.delassus_row[island.slot_begin];
    arrays.pair_end = indices.delassus_row[island.slot_end];
    return arrays;
  }
  const PairView& pairs = indices.pairs;
  const auto value_of = [&](std::int64_t pair) {
    return pair < pairs.value_start.size ? pairs.value_start[pair] : indices.jacobian_size;
  };
  arrays.pair_begin = pairs.pair_start[island.slot_begin];
  arrays.pair_end = pairs.pair_start[island.slot_end];
  arrays.value_begin = value_of(arrays.pair_begin);
  arrays.value_end = value_of(arrays.pair_end);
  arrays.link_begin = indices.block_contacts.start[island.block_begin];
  arrays.link_end = indices.block_contacts.start[island.block_end];
  return arrays;
}

/// Calls visit(view of the whole problem, first index, last index) for each array of an island that
/// its sweeps read or write, those used most often first.
template <class T, class Visit>
TETWARP_HD void for_each_island_array(const ContactIsland& island,
                                      const IslandArrays& arrays,
                                      ContactNumbers<T>& numbers,
                                      ContactState<T>& state,
                                      const Visit& visit) {
  const std::int64_t slot = island.slot_begin, slots_end = island.slot_end;
  const std::int64_t pair = arrays.pair_begin, pairs_end = arrays.pair_end;
  visit(state.impulse, 3 * slot, 3 * slots_end);
  if (numbers.is_local) {
    visit(numbers.delassus.row_start, slot, slots_end + 1);
    visit(numbers.delassus.column, pair, pairs_end);
    visit(numbers.constants, slot, slots_end);
    visit(numbers.delassus.free_velocity, 3 * slot, 3 * slots_end);
    visit(numbers.delassus.blocks, 9 * pair, 9 * pairs_end);
    return;
  }
  BodiesView<T>& bodies = numbers.bodies;
  visit(state.body_velocity, island.dof_begin, island.dof_end);
  visit(bodies.pairs.pair_start, slot, slots_end + 1);
  visit(bodies.pairs.block, pair, pairs_end);
  visit(bodies.pairs.value_start, pair, pairs_end);
  visit(bodies.pairs.dof_start, island.block_begin, island.block_end + 1);
  visit(numbers.constants, slot, slots_end);
  visit(bodies.offset, 3 * slot, 3 * slots_end);
  visit(bodies.jacobian, arrays.value_begin, arrays.value_end);
  visit(bodies.response, arrays.value_begin, arrays.value_end);
  visit(numbers.block_contacts.start, island.block_begin, island.block_end + 1);
  visit(numbers.block_contacts.contact, arrays.link_begin, arrays.link_end);
  visit(numbers.block_contacts.value, arrays.link_begin, arrays.link_end);
  visit(numbers.body_free, island.dof_begin, island.dof_end);
}

/// Bytes that the copy of an array takes.
template <class T>
TETWARP_HD std::int64_t cached_bytes(std::int64_t count) {
  return (count * static_cast<std::int64_t>(sizeof(T)) + 15) / 16 * 16;
}

/// Adds up the bytes of the copies of all arrays.
struct CachedBytes {
  std::int64_t* sum;

  template <class U>
  TETWARP_HD void operator()(View<U>&, std::int64_t first, std::int64_t last) const {
    *sum += cached_bytes<U>(last - first);
  }
};

/// Shared memory for all arrays of an island [bytes].
template <class T>
std::int64_t island_bytes(const ContactIsland& island, const IslandArrays& arrays, bool is_local) {
  ContactNumbers<T> numbers;
  numbers.is_local = is_local;
  ContactState<T> state;
  std::int64_t bytes = 0;
  for_each_island_array(island, arrays, numbers, state, CachedBytes{&bytes});
  return bytes;
}

/// Replaces the arrays of an island by copies in shared memory, one after the other while they fit.
template <class Exec>
class IslandCache {
 public:
  /// @param memory  of the block or the warp, aligned to 16 bytes
  /// @param bytes   its size
  __device__ IslandCache(const Exec& exec, void* memory, std::int64_t bytes)
      : exec_(exec), memory_(static_cast<unsigned char*>(memory)), bytes_(bytes) {}

  template <class T>
  __device__ void take(const ContactIsland& island,
                       const IslandArrays& arrays,
                       ContactNumbers<T>& numbers,
                       ContactState<T>& state) {
    for_each_island_array(
        island, arrays, numbers, state,
        [&](auto& view, std::int64_t first, std::int64_t last) { place(view, first, last); });
  }

 private:
  template <class U>
  __device__ __forceinline__ void place(View<U>& view, std::int64_t first, std::int64_t last) {
    const std::int64_t bytes = cached_bytes<U>(last - first);
    if (bytes > bytes_) return;
    using Value = std::remove_const_t<U>;
    Value* const copy = reinterpret_cast<Value*>(memory_);
    exec_.copy("contact/sweep", View<const Value>{view.data + first, last - first},
               View<Value>{copy, last - first});
    view.data = copy - first;
    memory_ += bytes;
    bytes_ -= bytes;
  }

  const Exec& exec_;
  unsigned char* memory_;
  std::int64_t bytes_;
};

}  // namespace tetwarp
