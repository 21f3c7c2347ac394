/// @file touching_sweeps.cpp
/// TouchingBlocks in the iteration: sweeps, velocities, residuals.
#include <algorithm>

#include "host/base/index_of.hpp"
#include "host/base/parallel.hpp"
#include "host/simulate/solve/two_level/touching_blocks.hpp"
#include "host/simulate/step/cpu/vector_stages.hpp"
#include "kernels/contact/contact_residual.hpp"

namespace tetwarp {
/// Copies Jacobian and responses of a contact to three rows of one length each, a multiple of four
/// that zeros fill up. Only contacts that are swept need it.
void TouchingBlocks::pack(std::size_t contact) {
  std::int32_t size = 0;
  for (std::int32_t p = part_start_[contact]; p < part_start_[contact + 1]; ++p) {
    size += parts_[index_of(p)].size;
  }
  size = (size + 3) / 4 * 4;
  packed_size_[contact] = size;
  packed_start_[contact] = static_cast<std::int64_t>(packed_.size());
  packed_.resize(packed_.size() + 6 * index_of(size), 0.0);
  if (gathered_.size() < index_of(size)) gathered_.resize(index_of(size));
  double* out = packed_.data() + packed_start_[contact];
  moves_rows_[contact] = 0;
  for (std::int32_t p = part_start_[contact]; p < part_start_[contact + 1]; ++p) {
    const Part& part = parts_[index_of(p)];
    const bool is_elastic = part.place != part.first;
    if (!is_elastic) moves_rows_[contact] = 1;
    for (std::int32_t a = 0; a < 3; ++a) {
      const std::int64_t from = part.value + a * part.size;
      std::copy_n((is_elastic ? turned_ : jacobian_).data() + from, part.size, out + a * size);
      if (!is_elastic) std::copy_n(response_.data() + from, part.size, out + (3 + a) * size);
    }
    out += part.size;
  }
}

/// Velocities of the nodes of the contact's group for unit impulses. @param z  out, [3][size]
void TouchingBlocks::set_unit_velocities(std::size_t contact, float* z) {
  const std::int32_t group = groups_.of_contact(contact);
  const std::size_t size = index_of(groups_.size(group));
  std::fill_n(z, 3 * size, 0.0F);
  for (std::int32_t p = part_start_[contact]; p < part_start_[contact + 1]; ++p) {
    const std::int32_t place = groups_.place_of_part(index_of(p));
    if (place < 0) continue;
    const float* const j = rounded_.data() + parts_[index_of(p)].value;
    for (std::size_t a = 0; a < 3; ++a) {
      groups_.add_velocities(group, place, j + 3 * a, z + a * size);
    }
  }
}

void TouchingBlocks::pack_elastic(std::size_t contact) {
  elastic_start_[contact] = static_cast<std::int64_t>(elastic_response_.size());
  const std::int64_t size = groups_.size(groups_.of_contact(contact));
  elastic_response_.resize(elastic_response_.size() + 3 * index_of(size));
  set_unit_velocities(contact, elastic_response_.data() + elastic_start_[contact]);
}

namespace {

/// std::copy_n() is a call, which takes longer than copying a few numbers.
void copy_threes(const double* from, std::int32_t size, double* to) {
  for (std::int32_t k = 0; k < size; k += 3) {
    const double a = from[k], b = from[k + 1], c = from[k + 2];
    to[k] = a, to[k + 1] = b, to[k + 2] = c;
  }
}

/// sum[a] += J_a . v, in four partial sums each, which compilers vectorize.
void add_products(const double* jacobian, std::int32_t size, const double* v, double* sum) {
  double lanes[3][4] = {};
  for (std::int32_t k = 0; k < size; k += 4) {
    for (int a = 0; a < 3; ++a) {
      for (int i = 0; i < 4; ++i) lanes[a][i] += jacobian[a * size + k + i] * v[k + i];
    }
  }
  for (int a = 0; a < 3; ++a) {
    sum[a] += (lanes[a][0] + lanes[a][1]) + (lanes[a][2] + lanes[a][3]);
  }
}

}  // namespace

/// The velocities that a contact depends on, in the order of its packed rows.
void TouchingBlocks::gather(std::size_t contact, const double* y) {
  double* out = gathered_.data();
  const double* const z = groups_.velocities(groups_.of_contact(contact));
  for (std::int32_t p = part_start_[contact]; p < part_start_[contact + 1]; ++p) {
    const Part& part = parts_[index_of(p)];
    const std::int32_t place = groups_.place_of_part(index_of(p));
    copy_threes(place < 0 ? y + part.place : z + place, part.size, out);
    out += part.size;
  }
  std::fill(out, gathered_.data() + packed_size_[contact], 0.0);
}

/// Copies the gathered velocities of rows back.
void TouchingBlocks::scatter(std::size_t contact, double* y) const {
  const double* in = gathered_.data();
  for (std::int32_t p = part_start_[contact]; p < part_start_[contact + 1]; ++p) {
    const Part& part = parts_[index_of(p)];
    if (part.place == part.first) copy_threes(in, part.size, y + part.place);
    in += part.size;
  }
}

/// Adds J^T change to the pushes of the group.
void TouchingBlocks::add_push_of_elastic(std::size_t contact, const double* change) {
  const std::int32_t size = packed_size_[contact];
  const double* j = packed_.data() + packed_start_[contact];
  double* const pushes = groups_.pushes(groups_.of_contact(contact));
  for (std::int32_t p = part_start_[contact]; p < part_start_[contact + 1]; ++p) {
    const std::int32_t place = groups_.place_of_part(index_of(p));
    if (place >= 0) {
      double* const push = pushes + place;
      for (std::int32_t k = 0; k < 3; ++k) {
        push[k] += j[k] * change[0] + j[size + k] * change[1] + j[2 * size + k] * change[2];
      }
    }
    j += parts_[index_of(p)].size;
  }
}

/// One update of a contact of the group that begin() was called for.
void TouchingBlocks::update(ContactSwitches switches, std::size_t c, double* y, double* impulse) {
  double* const v = gathered_.data();
  const std::int32_t size = packed_size_[c];
  const double* const jacobian = packed_.data() + packed_start_[c];
  const double* const response = jacobian + 3 * size;
  const std::int64_t moved = groups_.size(groups_.of_contact(c));
  operations_ += 6 * std::int64_t{size} + 3 * moved;
  gather(c, y);
  double u[3] = {offset_[3 * c], offset_[3 * c + 1], offset_[3 * c + 2]};
  add_products(jacobian, size, v, u);
  const double before[3] = {impulse[0], impulse[1], impulse[2]};
  solve_contact(laws_.constants[c], switches, u, impulse);
  const double change[3] = {impulse[0] - before[0], impulse[1] - before[1], impulse[2] - before[2]};
  if (change[0] == 0 && change[1] == 0 && change[2] == 0) return;
  if (moves_rows_[c] != 0) {
    for (std::int32_t k = 0; k < size; ++k) {
      v[k] += response[k] * change[0] + response[size + k] * change[1] +
              response[2 * size + k] * change[2];
    }
    scatter(c, y);
  }
  if (moved == 0) return;
  vector_stages().add_rows(elastic_response_.data() + elastic_start_[c], moved, change, moved,
                           groups_.velocities(groups_.of_contact(c)));
  if (!groups_.is_whole(groups_.of_contact(c))) add_push_of_elastic(c, change);
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

void TouchingBlocks::list_moved(const std::vector<std::int32_t>& list,
                                std::vector<std::int64_t>& places) {
  moved_.clear();
  for (const std::int32_t contact : list) {
    const std::size_t c = index_of(contact);
    for (std::int32_t p = part_start_[c]; p < part_start_[c + 1]; ++p) {
      const Part& part = parts_[index_of(p)];
      if (part.place == part.first) moved_.push_back({part.place, part.size});
    }
    groups_.list_ranges(groups_.of_contact(c), moved_);
  }
  std::sort(moved_.begin(), moved_.end());
  moved_.erase(std::unique(moved_.begin(), moved_.end()), moved_.end());
  places.clear();
  for (const auto& [first, size] : moved_) {
    for (std::int64_t k = 0; k < size; ++k) places.push_back(first + k);
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
                                     const double* free) {
  TouchingSums sums;
  working_.clear();
  for (std::size_t c = 0; c < laws_.constants.size(); ++c) {
    const ContactConstants<double>& own = laws_.constants[c];
    const double* const r = impulse + 3 * c;
    const double square =
        natural_square(own, switches, normal_weight(own), tangent_weight(own), r, velocity + 3 * c);
    if (square != 0 || r[0] != 0 || r[1] != 0 || r[2] != 0) {
      working_.push_back(static_cast<std::int32_t>(c));
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
