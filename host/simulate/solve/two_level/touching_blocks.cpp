/// @file touching_blocks.cpp
/// Sets J and its responses from the rows of contacts; products with them.
#include "host/simulate/solve/two_level/touching_blocks.hpp"

#include <algorithm>

#include "host/base/index_of.hpp"
#include "host/base/parallel.hpp"
#include "kernels/contact/contact_residual.hpp"

namespace tetwarp {
void TouchingBlocks::set(const StepSystem& system,
                         const TakenIslands& islands,
                         const ElasticSpace& elastic,
                         const ContactRows& rows,
                         const std::vector<std::int32_t>& contacts,
                         const ContactProblem& laws,
                         const DiagonalInverse<double>& inverse,
                         double relaxation) {
  laws_.set(laws);
  offset_ = laws.velocity_offset;
  set_parts(system, islands, elastic, rows, contacts);
  set_responses(rows, islands, elastic, inverse, relaxation);
}

/// The parts of all contacts, and the rows that they touch.
void TouchingBlocks::set_parts(const StepSystem& system,
                               const TakenIslands& islands,
                               const ElasticSpace& elastic,
                               const ContactRows& rows,
                               const std::vector<std::int32_t>& contacts) {
  row_of_block_.assign(index_of(system.rows.block_of.size), -1);
  for (std::int32_t row = 0; row < system.rows.unknown_count; ++row) {
    if (islands.of_row(row) >= 0) row_of_block_[index_of(system.rows.block_of[row])] = row;
  }
  part_start_.assign(1, 0);
  parts_.clear();
  part_row_.clear();
  part_entry_.clear();
  is_touched_.assign(index_of(system.rows.unknown_count), 0);
  std::int64_t numbers = 0;
  for (const std::int32_t contact : contacts) {
    const std::int32_t end = rows.start[index_of(contact) + 1];
    for (std::int32_t e = rows.start[index_of(contact)]; e < end; ++e) {
      const std::int32_t row = row_of_block_[index_of(rows.block[index_of(e)])];
      if (row < 0) continue;
      const bool is_rigid = system.rows.pair[row] == 1;
      const std::int32_t size = is_rigid ? 6 : 3;
      const std::int64_t first = 3 * std::int64_t{row};
      const std::int32_t body = elastic.body_of_row(row);
      const std::int64_t place = body < 0 ? first
                                          : elastic.bodies()[index_of(body)].first +
                                                3 * std::int64_t{elastic.slot_of_row(row)};
      parts_.push_back({first, place, numbers, size});
      part_row_.push_back(row);
      part_entry_.push_back(e);
      numbers += 3 * std::int64_t{size};
      is_touched_[index_of(row)] = 1;
      if (!is_rigid) continue;
      is_touched_[index_of(row) + 1] = 1;
      ++e;
    }
    part_start_.push_back(static_cast<std::int32_t>(parts_.size()));
  }
  touched_.clear();
  for (std::size_t row = 0; row < is_touched_.size(); ++row) {
    if (is_touched_[row] != 0) touched_.push_back(static_cast<std::int32_t>(row));
  }
  for (auto* values : {&jacobian_, &response_, &turned_}) values->resize(index_of(numbers));
  rounded_.resize(index_of(numbers));
}

/// Copies J of a contact: of rigid bodies, which have two entries, with rows of six.
void TouchingBlocks::set_jacobian(const ContactRows& rows, std::size_t contact) {
  for (std::int32_t p = part_start_[contact]; p < part_start_[contact + 1]; ++p) {
    const Part& part = parts_[index_of(p)];
    const std::size_t entry = index_of(part_entry_[index_of(p)]);
    for (std::int32_t i = 0; i < part.size; ++i) {
      const std::array<double, 9>& value = rows.value[entry + index_of(i / 3)];
      for (std::int32_t a = 0; a < 3; ++a) {
        jacobian_[index_of(part.value + a * part.size + i)] = value[index_of(3 * a + i % 3)];
      }
    }
  }
}

/// Turns J of a row of an elastic body, and adds its products with the rows of the same body before
/// it, and with itself, to the block of the contact.
void TouchingBlocks::add_elastic_block(const ElasticSpace& elastic,
                                       std::size_t contact,
                                       std::int32_t part) {
  const std::int32_t row = part_row_[index_of(part)], body = elastic.body_of_row(row);
  const ElasticBody& own = elastic.bodies()[index_of(body)];
  const auto& r = own.rotation;
  const double* const j = jacobian_.data() + parts_[index_of(part)].value;
  double* const turned = turned_.data() + parts_[index_of(part)].value;
  for (std::size_t e = 0; e < 9; ++e) {
    const double* const from = j + e / 3 * 3;
    turned[e] = from[0] * r[e % 3] + from[1] * r[3 + e % 3] + from[2] * r[6 + e % 3];
    rounded_[index_of(parts_[index_of(part)].value) + e] = static_cast<float>(turned[e]);
  }
  double* const block = laws_.constants[contact].block;
  for (std::int32_t q = part_start_[contact]; q <= part; ++q) {
    const std::int32_t other = part_row_[index_of(q)];
    if (elastic.body_of_row(other) != body) continue;
    const double* const second = turned_.data() + parts_[index_of(q)].value;
    const float* const g = own.compliance.data() +
                           3 * index_of(elastic.slot_of_row(other)) * index_of(own.size) +
                           3 * index_of(elastic.slot_of_row(row));
    for (std::size_t b = 0; b < 3; ++b) {
      double moved[3] = {};  // of the row for a unit impulse along axis b
      for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < 3; ++i) {
          moved[i] += g[k * index_of(own.size) + i] * second[3 * b + k];
        }
      }
      for (std::size_t a = 0; a < 3; ++a) {
        const double value =
            turned[3 * a] * moved[0] + turned[3 * a + 1] * moved[1] + turned[3 * a + 2] * moved[2];
        block[3 * a + b] += value;
        if (q != part) block[3 * b + a] += value;
      }
    }
  }
}

/// J, velocities for unit impulses, and the block of each contact.
void TouchingBlocks::set_responses(const ContactRows& rows,
                                   const TakenIslands& islands,
                                   const ElasticSpace& elastic,
                                   const DiagonalInverse<double>& inverse,
                                   double relaxation) {
  diagonal_.resize(3 * laws_.constants.size());
  parallel_for(threads(), count(), [&, this](std::int64_t contact) {
    const std::size_t c = index_of(contact);
    set_jacobian(rows, c);
    double* const block = laws_.constants[c].block;
    std::fill(block, block + 9, 0.0);
    for (std::int32_t p = part_start_[c]; p < part_start_[c + 1]; ++p) {
      const Part& part = parts_[index_of(p)];
      const std::int32_t row = part_row_[index_of(p)];
      if (elastic.body_of_row(row) >= 0) {
        add_elastic_block(elastic, c, p);
        continue;
      }
      const double* const m = inverse.at(row);
      const double factor =
          islands.list()[index_of(islands.of_row(row))].is_coupled ? relaxation : 1;
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
    laws_.constants[c].tangent_metric =
        larger_eigenvalue(block[4], (block[5] + block[7]) / 2, block[8]);
  });
}

void TouchingBlocks::push(const std::vector<std::int32_t>& list,
                          const double* before,
                          const double* after,
                          double* y) const {
  for (std::size_t k = 0; k < list.size(); ++k) {
    const std::size_t c = index_of(list[k]);
    const double r[3] = {after[3 * k] - before[3 * k], after[3 * k + 1] - before[3 * k + 1],
                         after[3 * k + 2] - before[3 * k + 2]};
    if (r[0] == 0 && r[1] == 0 && r[2] == 0) continue;
    for (std::int32_t p = part_start_[c]; p < part_start_[c + 1]; ++p) {
      const Part& part = parts_[index_of(p)];
      const double* const response = response_.data() + part.value;
      double* const v = y + part.place;
      for (std::int32_t i = 0; i < part.size; ++i) {
        v[i] += response[i] * r[0] + response[part.size + i] * r[1] +
                response[2 * part.size + i] * r[2];
      }
    }
  }
}

/// u of the rows of contacts.
void TouchingBlocks::velocity_at(std::size_t contact, const double* x, double* velocity) const {
  for (std::size_t a = 0; a < 3; ++a) velocity[a] = offset_[3 * contact + a];
  for (std::int32_t p = part_start_[contact]; p < part_start_[contact + 1]; ++p) {
    const Part& part = parts_[index_of(p)];
    for (int a = 0; a < 3; ++a) {
      const double* const j = jacobian_.data() + part.value + a * part.size;
      for (std::int32_t k = 0; k < part.size; ++k) velocity[a] += j[k] * x[part.first + k];
    }
  }
}

void TouchingBlocks::velocities_of_rows(const double* x, double* velocity) const {
  parallel_for(threads(), count(), [=, this](std::int64_t contact) {
    const std::size_t c = index_of(contact);
    velocity_at(c, x, velocity + 3 * c);
  });
}

TouchingSums TouchingBlocks::measure(ContactSwitches switches,
                                     const double* impulse,
                                     const double* velocity,
                                     const double* free,
                                     std::vector<std::int32_t>& working) const {
  TouchingSums sums;
  working.clear();
  for (std::size_t c = 0; c < laws_.constants.size(); ++c) {
    const ContactConstants<double>& own = laws_.constants[c];
    const double* const r = impulse + 3 * c;
    const double square =
        natural_square(own, switches, normal_weight(own), tangent_weight(own), r, velocity + 3 * c);
    if (square != 0 || r[0] != 0 || r[1] != 0 || r[2] != 0) {
      working.push_back(static_cast<std::int32_t>(c));
    }
    sums.natural += square;
    for (std::size_t a = 3 * c; a < 3 * c + 3; ++a) {
      sums.work += impulse[a] * (velocity[a] - free[a]);
    }
  }
  return sums;
}

/// force += J^T r of one contact.
void TouchingBlocks::add_push(std::size_t contact, const double* r, double* force) const {
  for (std::int32_t p = part_start_[contact]; p < part_start_[contact + 1]; ++p) {
    const Part& part = parts_[index_of(p)];
    const double* const j = jacobian_.data() + part.value;
    for (std::int32_t k = 0; k < part.size; ++k) {
      force[part.first + k] += j[k] * r[0] + j[part.size + k] * r[1] + j[2 * part.size + k] * r[2];
    }
  }
}

void TouchingBlocks::add_pushes(const double* impulse, double* force) const {
  for (std::size_t c = 0; c < laws_.constants.size(); ++c) add_push(c, impulse + 3 * c, force);
}

void TouchingBlocks::set_changes(const double* before, const double* after, double* force) const {
  for (const std::int32_t row : touched_) std::fill_n(force + 3 * std::int64_t{row}, 3, 0.0);
  for (std::size_t c = 0; c < laws_.constants.size(); ++c) {
    const double r[3] = {after[3 * c] - before[3 * c], after[3 * c + 1] - before[3 * c + 1],
                         after[3 * c + 2] - before[3 * c + 2]};
    if (r[0] == 0 && r[1] == 0 && r[2] == 0) continue;
    add_push(c, r, force);
  }
}

void TouchingBlocks::add_impulses(View<const double> load,
                                  const double* impulse,
                                  double* force) const {
  for (const std::int32_t row : touched_) {
    for (std::int64_t i = 3 * std::int64_t{row}; i < 3 * std::int64_t{row} + 3; ++i) {
      force[i] = load[i];
    }
  }
  for (std::size_t c = 0; c < laws_.constants.size(); ++c) {
    const double r[3] = {impulse[3 * c] - laws_.preload[c], impulse[3 * c + 1], impulse[3 * c + 2]};
    if (r[0] == 0 && r[1] == 0 && r[2] == 0) continue;
    add_push(c, r, force);
  }
}

}  // namespace tetwarp
