/// @file pair_sort.hpp
/// Pairs of cell and item on host threads: sorted by cell, and those that are not rejected.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/base/parallel.hpp"
#include "host/exec/host_buffer.hpp"
#include "kernels/base/cell_pair.hpp"
#include "kernels/base/view.hpp"

namespace tetwarp {

/// Copies the candidates that are not rejected, in order. @returns how many
inline std::int64_t copy_valid(int threads, View<const CellPair> candidates, View<CellPair> pairs) {
  std::vector<std::int64_t> kept(static_cast<std::size_t>(threads + 1));
  const auto for_each_part = [&](const auto& work) {
    parallel_tasks(threads, threads, [&](std::int64_t part) {
      work(static_cast<std::size_t>(part), candidates.size * part / threads,
           candidates.size * (part + 1) / threads);
    });
  };
  for_each_part([&](std::size_t part, std::int64_t begin, std::int64_t end) {
    std::int64_t sum = 0;
    for (std::int64_t i = begin; i < end; ++i) sum += candidates[i] != rejected_pair;
    kept[part + 1] = sum;
  });
  for (std::size_t p = 1; p < kept.size(); ++p) kept[p] += kept[p - 1];
  for_each_part([&](std::size_t part, std::int64_t begin, std::int64_t end) {
    const std::int64_t past = kept[part + 1];
    std::int64_t to = kept[part];
    for (std::int64_t i = begin; i < end && to < past; ++i) {
      pairs[to] = candidates[i];
      to += candidates[i] != rejected_pair;
    }
  });
  return kept.back();
}

/// Stable radix sort. Keeps its memory.
class PairSort {
 public:
  /// Sorts by the lowest `cell_bits` bits of the cell.
  void sort(int threads, View<CellPair> pairs, int cell_bits) {
    scratch_.reserve(pairs.size);
    CellPair* from = pairs.data;
    CellPair* to = scratch_.view(pairs.size).data;
    // As few passes as possible, with digits of about the same size.
    const int passes = (cell_bits + radix_bits - 1) / radix_bits;
    for (int pass = 0; pass < passes; ++pass) {
      const int shift = 32 + cell_bits * pass / passes;
      const int bits = 32 + cell_bits * (pass + 1) / passes - shift;
      sort_digit(threads, {from, pairs.size}, to, shift, bits);
      std::swap(from, to);
    }
    if (from != pairs.data) std::copy_n(from, pairs.size, pairs.data);
  }

 private:
  static constexpr int radix_bits = 11;

  /// One pass: stable, by `bits` bits from bit `shift` on. Each thread has a part of the pairs.
  void sort_digit(int threads, View<const CellPair> from, CellPair* to, int shift, int bits) {
    const std::int64_t digits = std::int64_t{1} << bits;
    const CellPair mask = static_cast<CellPair>(digits - 1);
    places_.assign(static_cast<std::size_t>(digits * threads), 0);
    const auto for_each_part = [&](const auto& visit) {
      parallel_tasks(threads, threads, [&](std::int64_t part) {
        std::int64_t* const place = places_.data() + digits * part;
        const std::int64_t end = from.size * (part + 1) / threads;
        for (std::int64_t i = from.size * part / threads; i < end; ++i) {
          visit(place[from[i] >> shift & mask], from[i]);
        }
      });
    };
    for_each_part([](std::int64_t& place, CellPair) { ++place; });
    std::int64_t sum = 0;
    for (std::int64_t digit = 0; digit < digits; ++digit) {
      for (int part = 0; part < threads; ++part) {
        sum += std::exchange(places_[static_cast<std::size_t>(digits * part + digit)], sum);
      }
    }
    for_each_part([to](std::int64_t& place, CellPair pair) { to[place++] = pair; });
  }

  HostBuffer<CellPair> scratch_;
  std::vector<std::int64_t> places_;  ///< [thread][digit]
};

}  // namespace tetwarp
