#include "host/simulate/contact/touching_blocks.hpp"

#include <algorithm>
#include <numeric>

#include "kernels/contact/contact_fill.hpp"

namespace tetwarp {
namespace {

std::size_t at(std::int64_t index) {
  return static_cast<std::size_t>(index);
}
template <class T>
View<const T> view_of(const std::vector<T>& own) {
  return {own.data(), static_cast<std::int64_t>(own.size())};
}

}  // namespace

void TouchingBlocks::set(const StepSystem& system,
                         const CoarseSpace& coarse,
                         const ContactRows& rows,
                         const std::vector<std::int32_t>& contacts,
                         const ContactProblem& laws,
                         const DiagonalInverse<double>& inverse,
                         double relaxation) {
  set_laws(laws);
  row_of_block_.assign(at(system.rows.block_of.size), -1);
  for (std::int32_t row = 0; row < system.rows.unknown_count; ++row) {
    if (coarse.island_of_row(row) >= 0) row_of_block_[at(system.rows.block_of[row])] = row;
  }
  part_start_.assign(1, 0);
  coarse_start_.clear();
  parts_.clear();
  part_item_.clear();
  jacobian_.clear();
  touched_.clear();
  for (const std::int32_t contact : contacts) add_rows(system, coarse, rows, contact);
  std::sort(touched_.begin(), touched_.end());
  touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
  set_responses(coarse, inverse, relaxation);
  packed_start_.assign(constants_.size(), -1);
  packed_size_.resize(constants_.size());
  packed_.clear();
  operations_ = 0;
}

void TouchingBlocks::set_laws(const ContactProblem& laws) {
  const AdhesionState& adhesion = laws.adhesion;
  const std::size_t count = laws.friction.size();
  slots_.resize(count);
  std::iota(slots_.begin(), slots_.end(), 0);
  constants_.resize(count);
  ContactInput input;
  input.friction = view_of(laws.friction);
  input.has_adhesion = true;
  input.time_step = adhesion.time_step;
  input.area = view_of(adhesion.area);
  input.stiffness = view_of(adhesion.stiffness);
  input.tangential_stiffness = view_of(adhesion.tangential_stiffness);
  input.intensity = view_of(adhesion.intensity);
  input.gap = view_of(adhesion.gap);
  const ContactConstantsBody body{
      input, view_of(slots_), {}, {constants_.data(), static_cast<std::int64_t>(count)}};
  offset_ = laws.velocity_offset;
  preload_.resize(count);
  for (std::size_t c = 0; c < count; ++c) {
    body(static_cast<std::int64_t>(c));
    preload_[c] = constants_[c].normal_spring *
                  (adhesion.gap[3 * c] / adhesion.time_step - laws.velocity_offset[3 * c]);
  }
}

/// Appends the parts of a contact.
void TouchingBlocks::add_rows(const StepSystem& system,
                              const CoarseSpace& coarse,
                              const ContactRows& rows,
                              std::int32_t contact) {
  const std::size_t first_part = parts_.size();
  const std::int32_t end = rows.start[at(contact) + 1];
  for (std::int32_t e = rows.start[at(contact)]; e < end; ++e) {
    const std::int32_t row = row_of_block_[at(rows.block[at(e)])];
    if (row < 0) continue;
    const bool is_rigid = system.rows.pair[row] == 1;
    const std::int32_t size = is_rigid ? 6 : 3;
    parts_.push_back({3 * std::int64_t{row}, static_cast<std::int64_t>(jacobian_.size()), size});
    part_item_.push_back(row);
    touched_.push_back(row);
    for (std::size_t k = 0; k < 3; ++k) {
      const double* const linear = rows.value[at(e)].data() + 3 * k;
      jacobian_.insert(jacobian_.end(), linear, linear + 3);
      if (!is_rigid) continue;
      const double* const angular = rows.value[at(e) + 1].data() + 3 * k;
      jacobian_.insert(jacobian_.end(), angular, angular + 3);
    }
    if (is_rigid) {
      touched_.push_back(row + 1);
      ++e;
    }
  }
  coarse_start_.push_back(static_cast<std::int32_t>(parts_.size()));
  add_modes(coarse, 3 * std::int64_t{system.rows.count}, first_part);
  part_start_.push_back(static_cast<std::int32_t>(parts_.size()));
}

/// Appends J Z of the islands that the parts from `first_part` on are in.
void TouchingBlocks::add_modes(const CoarseSpace& coarse,
                               std::int64_t coarse_begin,
                               std::size_t first_part) {
  const std::size_t last = parts_.size();
  for (std::size_t p = first_part; p < last; ++p) {
    const std::int32_t own = coarse.island_of_row(part_item_[p]);
    const CoarseIsland& island = coarse.islands()[at(own)];
    if (island.mode_count == 0) continue;
    std::size_t place = last;
    while (place < parts_.size() && part_item_[place] != own) ++place;
    if (place == parts_.size()) {
      parts_.push_back({coarse_begin + island.mode_begin,
                        static_cast<std::int64_t>(jacobian_.size()), island.mode_count});
      part_item_.push_back(own);
      jacobian_.resize(jacobian_.size() + 3 * at(island.mode_count), 0);
    }
    const Part part = parts_[p];
    double* const out = jacobian_.data() + parts_[place].value;
    const double* const j = jacobian_.data() + part.value;
    for (std::int32_t half = 0; half < part.size / 3; ++half) {
      const CoarseRow& row = coarse.row(part_item_[p] + half);
      for (std::int32_t k = 0; k < row.count; ++k) {
        for (std::int32_t a = 0; a < 3; ++a) {
          for (std::int32_t i = 0; i < 3; ++i) {
            out[a * island.mode_count + row.first + 3 * k + i] +=
                row.factor[k] * j[a * part.size + 3 * half + i];
          }
        }
      }
    }
  }
}

/// Velocities for unit impulses, and the block of each contact.
void TouchingBlocks::set_responses(const CoarseSpace& coarse,
                                   const DiagonalInverse<double>& inverse,
                                   double relaxation) {
  response_.resize(jacobian_.size());
  diagonal_.resize(3 * constants_.size());
  for (std::size_t c = 0; c < constants_.size(); ++c) {
    double* const block = constants_[c].block;
    std::fill(block, block + 9, 0.0);
    for (std::int32_t p = part_start_[c]; p < part_start_[c + 1]; ++p) {
      const Part& part = parts_[at(p)];
      const bool is_coarse = p >= coarse_start_[c];
      const CoarseIsland& island = coarse.islands()[at(
          is_coarse ? part_item_[at(p)] : coarse.island_of_row(part_item_[at(p)]))];
      const double* const m = is_coarse ? coarse.inverse().data() + island.inverse_begin
                                        : inverse.at(part_item_[at(p)]);
      const double factor = is_coarse || !island.is_coupled ? 1 : relaxation;
      const double* const j = jacobian_.data() + part.value;
      double* const response = response_.data() + part.value;
      const std::int32_t n = part.size;
      for (std::int32_t i = 0; i < n; ++i) {
        for (std::int32_t a = 0; a < 3; ++a) {
          double sum = 0;
          for (std::int32_t k = 0; k < n; ++k) sum += m[i * n + k] * j[a * n + k];
          response[a * n + i] = factor * sum;
        }
      }
      for (std::int32_t a = 0; a < 3; ++a) {
        for (std::int32_t e = 0; e < 3; ++e) {
          for (std::int32_t k = 0; k < n; ++k) {
            block[3 * a + e] += j[a * n + k] * response[e * n + k];
          }
        }
      }
    }
    for (std::size_t a = 0; a < 3; ++a) diagonal_[3 * c + a] = block[4 * a];
    constants_[c].tangent_metric = larger_eigenvalue(block[4], (block[5] + block[7]) / 2, block[8]);
  }
}

}  // namespace tetwarp
