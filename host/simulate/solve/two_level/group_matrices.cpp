/// @file group_matrices.cpp
/// Makes the matrices two contacts at a time; projected Gauss-Seidel on their columns.
#include "host/simulate/solve/two_level/group_matrices.hpp"

#include <algorithm>
#include <functional>
#include <iterator>

#include "host/base/index_of.hpp"
#include "host/base/parallel.hpp"
#include "host/simulate/solve/two_level/unit_velocities.hpp"
#include "host/simulate/step/cpu/vector_stages.hpp"

namespace tetwarp {
namespace {

/// u += J v of one block. @param j  three rows of three
void add_velocity(const double* j, const double* v, double* u) {
  for (int a = 0; a < 3; ++a) u[a] += j[3 * a] * v[0] + j[3 * a + 1] * v[1] + j[3 * a + 2] * v[2];
}

}  // namespace

/// Sets the block of the k-th and the m-th contact of a group, and its transpose.
/// @param block  [3][8]
void GroupMatrices::set_entries(Matrix& matrix, std::size_t k, std::size_t m, const float* block) {
  const std::size_t stride = index_of(matrix.stride);
  float* const column = matrix.values.data() + 3 * k * stride + 3 * m;
  float* const mirrored = matrix.values.data() + 3 * m * stride + 3 * k;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) column[b * stride + a] = block[8 * a + b];
    if (m == k) continue;
    for (std::size_t b = 0; b < 3; ++b) mirrored[a * stride + b] = block[8 * a + b];
  }
}

void GroupMatrices::make(std::int32_t group) {
  const std::vector<std::int32_t>& contacts = groups_.contacts(group);
  const std::vector<std::int32_t>& start = blocks_.block_start();
  Matrix& own = matrices_[index_of(group)];
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
      place_[index_of(contacts[k + s])] = 3 * static_cast<std::int32_t>(k + s);
      set_unit_velocities(blocks_, groups_, index_of(contacts[k + s]),
                          own.moved.data() + 3 * s * size);
    }
    for (std::size_t n = 0; n < 3 * columns; ++n) {
      float* const column = own.columns.data() + n / 3 * 4 + n % 3;
      for (std::size_t i = 0; i < size; ++i) column[8 * i] = own.moved[n * size + i];
    }
    for (std::size_t m = k; m < contacts.size(); ++m) {
      const std::size_t other = index_of(contacts[m]);
      float block[3][8] = {};
      vector_stages().add_blocks(blocks_.rounded(index_of(start[other])),
                                 groups_.places_of_blocks(index_of(start[other])),
                                 start[other + 1] - start[other], own.columns.data(), block[0]);
      for (std::size_t s = 0; s < std::min(columns, m - k + 1); ++s) {
        set_entries(own, k + s, m, block[0] + 4 * s);
      }
    }
  }
}

void GroupMatrices::make(const std::vector<std::int32_t>& changed, int threads) {
  place_.resize(index_of(blocks_.count()));
  matrices_.resize(std::max(matrices_.size(), index_of(groups_.count())));
  std::vector<std::int32_t> made;
  std::ranges::copy_if(changed, std::back_inserter(made),
                       [this](std::int32_t group) { return has(group); });
  // The one that takes longest first.
  std::ranges::stable_sort(made, std::ranges::greater{}, [&](std::int32_t group) {
    return groups_.contacts(group).size() * index_of(groups_.size(group));
  });
  parallel_tasks(threads, static_cast<std::int64_t>(made.size()),
                 [&](std::int64_t k) { make(made[index_of(k)]); });
}

/// Sets u = J z + w of the contacts of a range.
void GroupMatrices::set_velocities(const GroupRange& range,
                                   const std::vector<std::int32_t>& list,
                                   const double* y) {
  Matrix& own = matrices_[index_of(range.group)];
  groups_.begin(range.group, y);
  const double* const z = groups_.velocities(range.group);
  for (std::size_t k = range.begin; k < range.end; ++k) {
    const std::size_t c = index_of(list[k]);
    double* const u = own.velocity.data() + place_[c];
    std::copy_n(blocks_.offset(c), 3, u);
    blocks_.for_blocks(c, [&](std::size_t b) {
      add_velocity(blocks_.turned(b), z + groups_.place_of_block(b), u);
    });
  }
}

/// Adds (J R)^T of what the sweep has changed to the pushes of the group.
void GroupMatrices::add_pushes(const GroupRange& range,
                               const std::vector<std::int32_t>& list,
                               const double* impulse) {
  const Matrix& own = matrices_[index_of(range.group)];
  double* const pushes = groups_.pushes(range.group);
  for (std::size_t k = range.begin; k < range.end; ++k) {
    const double* const r = impulse + 3 * k;
    const double* const before = own.before.data() + 3 * (k - range.begin);
    const double change[3] = {r[0] - before[0], r[1] - before[1], r[2] - before[2]};
    blocks_.for_blocks(index_of(list[k]), [&](std::size_t b) {
      const double* const j = blocks_.turned(b);
      double* const push = pushes + groups_.place_of_block(b);
      for (int i = 0; i < 3; ++i) {
        push[i] += j[i] * change[0] + j[3 + i] * change[1] + j[6 + i] * change[2];
      }
    });
  }
}

void GroupMatrices::sweep(ContactSwitches switches,
                          const GroupRange& range,
                          const std::vector<std::int32_t>& list,
                          const double* y,
                          double* impulse) {
  Matrix& own = matrices_[index_of(range.group)];
  set_velocities(range, list, y);
  std::copy_n(impulse + 3 * range.begin, 3 * range.size(), own.before.data());
  for (int pass = 0; pass < range.passes; ++pass) {
    for (std::size_t k = range.begin; k < range.end; ++k) {
      const std::int64_t place = place_[index_of(list[k])];
      const double* const u = own.velocity.data() + place;
      double* const r = impulse + 3 * k;
      double free[3] = {u[0], u[1], u[2]}, change[3] = {-r[0], -r[1], -r[2]};
      solve_contact(blocks_.law(index_of(list[k])), switches, free, r);
      for (int a = 0; a < 3; ++a) change[a] += r[a];
      if (change[0] == 0 && change[1] == 0 && change[2] == 0) continue;
      vector_stages().add_rows(own.values.data() + place * own.stride, own.stride, change,
                               own.stride, own.velocity.data());
    }
  }
  add_pushes(range, list, impulse);
}

}  // namespace tetwarp
