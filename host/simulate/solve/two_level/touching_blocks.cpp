/// @file touching_blocks.cpp
/// Sets J and its responses from the rows of contacts; products with them.
#include "host/simulate/solve/two_level/touching_blocks.hpp"

#include <algorithm>

#include "host/base/index_of.hpp"
#include "host/base/parallel.hpp"
#include "host/base/vector_view.hpp"

namespace tetwarp {

void TouchingBlocks::set(const CompliantLists& lists,
                         const ElasticSpace& elastic,
                         const ContactRows& rows,
                         const std::vector<std::int32_t>& contacts,
                         const TwoLevelStart& start,
                         const DiagonalInverse<double>& inverse) {
  lists_ = &lists;
  laws_ = start.laws;
  offset_ = start.offset;
  diagonal_.resize(offset_.size());
  jacobian_.set(rows, contacts, lists.row_of_block);
  list_touched(elastic);
  parallel_for(threads(), count(), [&, this](std::int64_t contact) {
    set_own_block(elastic, inverse, index_of(contact));
  });
}

/// Lists where blocks are in y, and the rows that they touch.
void TouchingBlocks::list_touched(const ElasticSpace& elastic) {
  place_.clear();
  is_touched_.assign(index_of(lists_->row_count()), 0);
  for (const std::int32_t row : row()) {
    const std::int32_t body = elastic.body_of_row(row);
    place_.push_back(body < 0 ? 3 * std::int64_t{row}
                              : elastic.bodies()[index_of(body)].first +
                                    3 * std::int64_t{elastic.slot_of_row(row)});
    is_touched_[index_of(row)] = 1;
  }
  touched_.clear();
  for (std::size_t row = 0; row < is_touched_.size(); ++row) {
    if (is_touched_[row] != 0) touched_.push_back(static_cast<std::int32_t>(row));
  }
  for (auto* values : {&response_, &turned_}) values->resize(9 * jacobian_.block_count());
  rounded_.resize(turned_.size());
}

/// Turns J of a row of an elastic body, and adds its products with the rows of the same body before
/// it, and with itself, to the block of the contact.
void TouchingBlocks::add_elastic_block(const ElasticSpace& elastic,
                                       std::size_t contact,
                                       std::size_t block) {
  const std::int32_t row = this->row()[block], body = elastic.body_of_row(row);
  const ElasticBody& own = elastic.bodies()[index_of(body)];
  const auto& r = own.rotation;
  const double* const j = jacobian(block);
  double* const turned = turned_.data() + 9 * block;
  for (std::size_t e = 0; e < 9; ++e) {
    const double* const from = j + e / 3 * 3;
    turned[e] = from[0] * r[e % 3] + from[1] * r[3 + e % 3] + from[2] * r[6 + e % 3];
    rounded_[9 * block + e] = static_cast<float>(turned[e]);
  }
  double* const sum = laws_.constants[contact].block;
  for (std::size_t other = index_of(block_start()[contact]); other <= block; ++other) {
    if (elastic.body_of_row(this->row()[other]) != body) continue;
    const double* const second = this->turned(other);
    const float* const g =
        own.compliance.data() +
        3 * index_of(elastic.slot_of_row(this->row()[other])) * index_of(own.size) +
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
        sum[3 * a + b] += value;
        if (other != block) sum[3 * b + a] += value;
      }
    }
  }
}

/// M^-1 J^T of a row whose body gives way by its diagonal block: a sum over the rows of the body.
void TouchingBlocks::set_response(const DiagonalInverse<double>& inverse,
                                  std::size_t contact,
                                  std::size_t block) {
  const std::int32_t row = this->row()[block];
  const CompliantBody& own = lists_->body_at(row);
  double* const response = response_.data() + 9 * block;
  std::fill_n(response, 9, 0.0);
  const std::int32_t size = 3 * own.count;
  for_blocks(contact, [&](std::size_t other) {
    const std::int32_t column = this->row()[other] - own.first;
    if (column < 0 || column >= own.count) return;
    const double* const m =
        inverse.at(own.system_row) + 3 * std::ptrdiff_t{row - own.first} * size + 3 * column;
    const double* const j = jacobian(other);
    for (std::int32_t e = 0; e < 9; ++e) {
      const double *const line = m + e % 3 * size, *const along = j + e / 3 * 3;
      response[e] +=
          own.relaxation * (line[0] * along[0] + line[1] * along[1] + line[2] * along[2]);
    }
  });
}

/// Responses and the block of a contact.
void TouchingBlocks::set_own_block(const ElasticSpace& elastic,
                                   const DiagonalInverse<double>& inverse,
                                   std::size_t contact) {
  ContactConstants<double>& law = laws_.constants[contact];
  std::fill(law.block, law.block + 9, 0.0);
  for_blocks(contact, [&](std::size_t b) {
    if (is_elastic(b)) return add_elastic_block(elastic, contact, b);
    set_response(inverse, contact, b);
    const double *const j = jacobian(b), *const moved = response(b);
    for (std::size_t e = 0; e < 9; ++e) {
      const double *const first = j + e / 3 * 3, *const second = moved + e % 3 * 3;
      law.block[e] += first[0] * second[0] + first[1] * second[1] + first[2] * second[2];
    }
  });
  for (std::size_t a = 0; a < 3; ++a) diagonal_[3 * contact + a] = law.block[4 * a];
  law.tangent_metric =
      larger_eigenvalue(law.block[4], (law.block[5] + law.block[7]) / 2, law.block[8]);
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
    for_blocks(c, [&](std::size_t b) {
      const double* const moved = response(b);
      double* const v = y + place(b);
      for (int i = 0; i < 3; ++i) {
        v[i] += moved[i] * r[0] + moved[3 + i] * r[1] + moved[6 + i] * r[2];
      }
    });
  }
}

TouchingSums TouchingBlocks::measure(ContactSwitches switches,
                                     const double* impulse,
                                     const double* velocity,
                                     const double* free,
                                     std::vector<std::int32_t>& working) const {
  const auto numbers_of = [this](const double* of) { return View<const double>{of, 3 * count()}; };
  const TouchErrorOp op{view_of(laws_.constants), switches, numbers_of(impulse),
                        numbers_of(velocity), numbers_of(free)};
  TouchingSums sums;
  working.clear();
  for (std::int64_t c = 0; c < count(); ++c) {
    const PlainSums<2> own = op(c);
    const double* const r = impulse + 3 * c;
    if (own.value[0] != 0 || r[0] != 0 || r[1] != 0 || r[2] != 0) {
      working.push_back(static_cast<std::int32_t>(c));
    }
    sums.natural += own.value[0];
    sums.work += own.value[1];
  }
  return sums;
}

void TouchingBlocks::set_changes(const double* before, const double* after, double* force) const {
  for (const std::int32_t row : touched_) std::fill_n(force + 3 * std::int64_t{row}, 3, 0.0);
  for (std::size_t c = 0; c < laws_.constants.size(); ++c) {
    const double r[3] = {after[3 * c] - before[3 * c], after[3 * c + 1] - before[3 * c + 1],
                         after[3 * c + 2] - before[3 * c + 2]};
    if (r[0] == 0 && r[1] == 0 && r[2] == 0) continue;
    jacobian_.add_push(c, r, force);
  }
}

void TouchingBlocks::add_impulses(View<const double> load,
                                  const double* impulse,
                                  double* force) const {
  for (const std::int32_t row : touched_) {
    const std::int64_t place = lists_->system_row[index_of(row)];
    for (std::int64_t i = 0; i < 3; ++i) force[3 * std::int64_t{row} + i] = load[3 * place + i];
  }
  for (std::size_t c = 0; c < laws_.constants.size(); ++c) {
    const double r[3] = {impulse[3 * c] - laws_.preload[c], impulse[3 * c + 1], impulse[3 * c + 2]};
    if (r[0] == 0 && r[1] == 0 && r[2] == 0) continue;
    jacobian_.add_push(c, r, force);
  }
}

}  // namespace tetwarp
