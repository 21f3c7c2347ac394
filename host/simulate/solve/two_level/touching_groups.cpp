/// @file touching_groups.cpp
/// TouchingBlocks: sweeps over groups of contacts between the same elastic bodies.
#include <algorithm>
#include <array>
#include <functional>
#include <span>

#include "host/base/index_of.hpp"
#include "host/base/parallel.hpp"
#include "host/simulate/solve/two_level/touching_blocks.hpp"
#include "host/simulate/step/cpu/vector_stages.hpp"

namespace tetwarp {
namespace {

// Passes in a sweep over a group of a few contacts among others: bonds make impulses within a group
// converge slowly. Passes over one group alone are sweeps without acceleration, and those over
// many contacts take longer than they save.
constexpr int group_passes = 3;
constexpr std::size_t most_of_passes = 64;  // contacts
// Multiplications from which two threads are faster than one.
constexpr std::int64_t parallel_from = 2'000;

/// u += J v of one part. @param j  three rows of three
void add_velocity(const double* j, const double* v, double* u) {
  for (int a = 0; a < 3; ++a) u[a] += j[3 * a] * v[0] + j[3 * a + 1] * v[1] + j[3 * a + 2] * v[2];
}

}  // namespace

/// Whether the impulses of a group act on each other by a matrix instead of velocities of nodes.
bool TouchingBlocks::has_matrix(std::int32_t group) const {
  return groups_.size(group) > 0 && !groups_.is_whole(group) && groups_.is_pure(group);
}

/// The block of the m-th and the k-th contact of a group, which is symmetric. @param block  [3][8]
void TouchingBlocks::set_entries(GroupMatrix& matrix,
                                 std::size_t k,
                                 std::size_t m,
                                 const float* block) {
  const std::size_t stride = index_of(matrix.stride);
  float* const column = matrix.values.data() + 3 * k * stride + 3 * m;
  float* const mirrored = matrix.values.data() + 3 * m * stride + 3 * k;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) column[b * stride + a] = block[8 * a + b];
    if (m == k) continue;
    for (std::size_t b = 0; b < 3; ++b) mirrored[a * stride + b] = block[8 * a + b];
  }
}

void TouchingBlocks::set_matrix(std::int32_t group) {
  const std::vector<std::int32_t>& contacts = groups_.contacts(group);
  GroupMatrix& own = matrices_[index_of(group)];
  const std::size_t size = index_of(groups_.size(group));
  own.stride = (3 * static_cast<std::int64_t>(contacts.size()) + 7) / 8 * 8;
  own.values.assign(3 * contacts.size() * index_of(own.stride), 0);
  own.velocity.assign(index_of(own.stride), 0);
  own.before.resize(3 * contacts.size());
  own.moved.assign(6 * size, 0);
  own.columns.assign(8 * size, 0);
  for (std::size_t k = 0; k < contacts.size(); k += 2) {
    const std::size_t columns = std::min<std::size_t>(2, contacts.size() - k);
    for (std::size_t s = 0; s < columns; ++s) {
      matrix_place_[index_of(contacts[k + s])] = 3 * static_cast<std::int32_t>(k + s);
      set_unit_velocities(index_of(contacts[k + s]), own.moved.data() + 3 * s * size);
    }
    for (std::size_t n = 0; n < 3 * columns; ++n) {
      float* const column = own.columns.data() + n / 3 * 4 + n % 3;
      for (std::size_t i = 0; i < size; ++i) column[8 * i] = own.moved[n * size + i];
    }
    for (std::size_t m = k; m < contacts.size(); ++m) {
      const std::size_t other = index_of(contacts[m]);
      const std::size_t first = index_of(part_start_[other]);
      float block[3][8] = {};
      vector_stages().add_blocks(
          rounded_.data() + parts_[first].value, groups_.places_of_parts(first),
          part_start_[other + 1] - part_start_[other], own.columns.data(), block[0]);
      for (std::size_t s = 0; s < std::min(columns, m - k + 1); ++s) {
        set_entries(own, k + s, m, block[0] + 4 * s);
      }
    }
  }
}

void TouchingBlocks::begin_sweeps() {
  std::vector<std::int32_t> made;
  for (const std::int32_t group : groups_.group(working_, threads_)) {
    for (const std::int32_t contact : groups_.contacts(group)) {
      elastic_start_[index_of(contact)] = -1;
    }
    if (has_matrix(group)) made.push_back(group);
  }
  matrices_.resize(std::max(matrices_.size(), index_of(groups_.count())));
  // The one that takes longest first.
  std::ranges::stable_sort(made, std::ranges::greater{}, [&](std::int32_t group) {
    return groups_.contacts(group).size() * index_of(groups_.size(group));
  });
  parallel_tasks(threads_, static_cast<std::int64_t>(made.size()),
                 [&](std::int64_t k) { set_matrix(made[index_of(k)]); });
}

int TouchingBlocks::passes_over(const Range& range, const std::vector<std::int32_t>& list) const {
  const bool is_alone = range.end - range.begin == list.size();
  const bool is_small = groups_.contacts(range.group).size() <= most_of_passes;
  return groups_.size(range.group) > 0 && is_small && !is_alone ? group_passes : 1;
}

/// The contacts of a group without a matrix.
void TouchingBlocks::sweep_in_turn(ContactSwitches switches,
                                   const Range& range,
                                   const std::vector<std::int32_t>& list,
                                   double* y,
                                   double* impulse) {
  for (std::size_t k = range.begin; k < range.end; ++k) {
    const std::size_t c = index_of(list[k]);
    if (packed_start_[c] < 0) pack(c);
    if (elastic_start_[c] < 0) pack_elastic(c);
  }
  const int passes = passes_over(range, list);
  groups_.begin(range.group, y);
  for (int pass = 0; pass < passes; ++pass) {
    for (std::size_t k = range.begin; k < range.end; ++k) {
      update(switches, index_of(list[k]), y, impulse + 3 * k);
    }
  }
  operations_ += groups_.finish({&range.group, 1}, y, 1);
}

/// The contacts of a group with a matrix; leaves their pushes to ElasticGroups::finish().
void TouchingBlocks::sweep_matrix(ContactSwitches switches,
                                  const Range& range,
                                  const std::vector<std::int32_t>& list,
                                  const double* y,
                                  double* impulse) {
  GroupMatrix& own = matrices_[index_of(range.group)];
  groups_.begin(range.group, y);
  const double* const z = groups_.velocities(range.group);
  const std::size_t count = range.end - range.begin;
  for (std::size_t k = range.begin; k < range.end; ++k) {
    const std::size_t c = index_of(list[k]);
    double* const u = own.velocity.data() + matrix_place_[c];
    std::copy_n(offset_.data() + 3 * c, 3, u);
    for (std::int32_t p = part_start_[c]; p < part_start_[c + 1]; ++p) {
      add_velocity(turned_.data() + parts_[index_of(p)].value,
                   z + groups_.place_of_part(index_of(p)), u);
    }
  }
  std::copy_n(impulse + 3 * range.begin, 3 * count, own.before.data());
  const int passes = passes_over(range, list);
  for (int pass = 0; pass < passes; ++pass) {
    for (std::size_t k = range.begin; k < range.end; ++k) {
      const std::int64_t place = matrix_place_[index_of(list[k])];
      const double* const u = own.velocity.data() + place;
      double* const r = impulse + 3 * k;
      double free[3] = {u[0], u[1], u[2]}, change[3] = {-r[0], -r[1], -r[2]};
      solve_contact(laws_.constants[index_of(list[k])], switches, free, r);
      for (int a = 0; a < 3; ++a) change[a] += r[a];
      if (change[0] == 0 && change[1] == 0 && change[2] == 0) continue;
      vector_stages().add_rows(own.values.data() + place * own.stride, own.stride, change,
                               own.stride, own.velocity.data());
    }
  }
  double* const pushes = groups_.pushes(range.group);
  for (std::size_t k = range.begin; k < range.end; ++k) {
    const double* const r = impulse + 3 * k;
    const double* const before = own.before.data() + 3 * (k - range.begin);
    const double change[3] = {r[0] - before[0], r[1] - before[1], r[2] - before[2]};
    const std::size_t c = index_of(list[k]);
    for (std::int32_t p = part_start_[c]; p < part_start_[c + 1]; ++p) {
      const double* const j = turned_.data() + parts_[index_of(p)].value;
      double* const push = pushes + groups_.place_of_part(index_of(p));
      for (int i = 0; i < 3; ++i) {
        push[i] += j[i] * change[0] + j[3 + i] * change[1] + j[6 + i] * change[2];
      }
    }
  }
}

void TouchingBlocks::sweep(ContactSwitches switches,
                           const std::vector<std::int32_t>& list,
                           double* y,
                           double* impulse) {
  ranges_.clear();
  for (std::size_t begin = 0, end = 0; begin < list.size(); begin = end) {
    const std::int32_t group = groups_.of_contact(index_of(list[begin]));
    while (end < list.size() && groups_.of_contact(index_of(list[end])) == group) ++end;
    const Range range{group, begin, end};
    if (!has_matrix(group)) {
      sweep_in_turn(switches, range, list, y, impulse);
      continue;
    }
    const std::int64_t stride = matrices_[index_of(group)].stride;
    ranges_.push_back(range);
    ranges_.back().operations =
        static_cast<std::int64_t>(end - begin) * (3 * passes_over(range, list) * stride + 200);
  }
  // Side by side what takes about as long.
  std::ranges::stable_sort(ranges_, std::ranges::greater{}, &Range::operations);
  for (std::size_t k = 0; k < ranges_.size(); k += 2) {
    const std::span<const Range> pair(ranges_.data() + k,
                                      std::min(ranges_.size() - k, std::size_t{2}));
    const int threads = pair.back().operations < parallel_from ? 1 : threads_;
    parallel_tasks(threads, static_cast<std::int64_t>(pair.size()), [&](std::int64_t m) {
      sweep_matrix(switches, pair[index_of(m)], list, y, impulse);
    });
    const std::array<std::int32_t, 2> groups{pair.front().group, pair.back().group};
    for (const Range& range : pair) operations_ += range.operations;
    operations_ += groups_.finish({groups.data(), pair.size()}, y, threads);
  }
}

}  // namespace tetwarp
