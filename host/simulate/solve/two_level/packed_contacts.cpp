/// @file packed_contacts.cpp
/// Packs contacts; projected Gauss-Seidel over them.
#include "host/simulate/solve/two_level/packed_contacts.hpp"

#include <algorithm>

#include "host/base/index_of.hpp"
#include "host/simulate/solve/two_level/unit_velocities.hpp"
#include "host/simulate/step/cpu/vector_stages.hpp"

namespace tetwarp {
namespace {

/// std::copy_n() is a function call, which takes longer than copying three numbers.
void copy_three(const double* from, double* to) {
  const double a = from[0], b = from[1], c = from[2];
  to[0] = a, to[1] = b, to[2] = c;
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

void PackedContacts::clear() {
  const std::size_t count = index_of(blocks_.count());
  start_.assign(count, -1);
  size_.resize(count);
  moves_rows_.resize(count);
  packed_.clear();
  elastic_start_.assign(count, -1);
  elastic_response_.clear();
}

/// Copies J and responses of a contact to three rows each, filled up with zeros to a multiple of
/// four numbers.
void PackedContacts::pack(std::size_t contact) {
  const std::vector<std::int32_t>& start = blocks_.block_start();
  const std::int32_t size = (3 * (start[contact + 1] - start[contact]) + 3) / 4 * 4;
  size_[contact] = size;
  start_[contact] = static_cast<std::int64_t>(packed_.size());
  packed_.resize(packed_.size() + 6 * index_of(size), 0.0);
  if (gathered_.size() < index_of(size)) gathered_.resize(index_of(size));
  double* out = packed_.data() + start_[contact];
  moves_rows_[contact] = 0;
  blocks_.for_blocks(contact, [&](std::size_t b) {
    const bool is_elastic = blocks_.is_elastic(b);
    if (!is_elastic) moves_rows_[contact] = 1;
    const double* const j = is_elastic ? blocks_.turned(b) : blocks_.jacobian(b);
    for (std::int32_t a = 0; a < 3; ++a) {
      copy_three(j + 3 * a, out + a * size);
      if (!is_elastic) copy_three(blocks_.response(b) + 3 * a, out + (3 + a) * size);
    }
    out += 3;
  });
}

/// Keeps how the nodes of the group give way to the contact.
void PackedContacts::pack_elastic(std::size_t contact) {
  elastic_start_[contact] = static_cast<std::int64_t>(elastic_response_.size());
  const std::int64_t size = groups_.size(groups_.of_contact(contact));
  elastic_response_.resize(elastic_response_.size() + 3 * index_of(size));
  set_unit_velocities(blocks_, groups_, contact,
                      elastic_response_.data() + elastic_start_[contact]);
}

/// Copies the velocities that a contact depends on, in the order of its packed rows.
void PackedContacts::gather(std::size_t contact, const double* y) {
  double* out = gathered_.data();
  const double* const z = groups_.velocities(groups_.of_contact(contact));
  blocks_.for_blocks(contact, [&](std::size_t b) {
    const std::int32_t place = groups_.place_of_block(b);
    copy_three(place < 0 ? y + blocks_.place(b) : z + place, out);
    out += 3;
  });
  std::fill(out, gathered_.data() + size_[contact], 0.0);
}

/// Copies the gathered velocities of rows back.
void PackedContacts::scatter(std::size_t contact, double* y) const {
  const double* in = gathered_.data();
  blocks_.for_blocks(contact, [&](std::size_t b) {
    if (!blocks_.is_elastic(b)) copy_three(in, y + blocks_.place(b));
    in += 3;
  });
}

/// Adds J^T change to the pushes of the group.
void PackedContacts::add_push_of_elastic(std::size_t contact, const double* change) {
  double* const pushes = groups_.pushes(groups_.of_contact(contact));
  blocks_.for_blocks(contact, [&](std::size_t b) {
    const std::int32_t place = groups_.place_of_block(b);
    if (place < 0) return;
    const double* const j = blocks_.turned(b);
    double* const push = pushes + place;
    for (int k = 0; k < 3; ++k) {
      push[k] += j[k] * change[0] + j[3 + k] * change[1] + j[6 + k] * change[2];
    }
  });
}

/// One update of a contact. @pre ElasticGroups::begin() of its group
void PackedContacts::update(ContactSwitches switches, std::size_t c, double* y, double* impulse) {
  double* const v = gathered_.data();
  const std::int32_t size = size_[c];
  const double* const jacobian = packed_.data() + start_[c];
  const double* const response = jacobian + 3 * size;
  const std::int64_t moved = groups_.size(groups_.of_contact(c));
  operations_ += 6 * std::int64_t{size} + 3 * moved;
  gather(c, y);
  const double* const offset = blocks_.offset(c);
  double u[3] = {offset[0], offset[1], offset[2]};
  add_products(jacobian, size, v, u);
  const double before[3] = {impulse[0], impulse[1], impulse[2]};
  solve_contact(blocks_.law(c), switches, u, impulse);
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

std::int64_t PackedContacts::sweep(ContactSwitches switches,
                                   const GroupRange& range,
                                   const std::vector<std::int32_t>& list,
                                   double* y,
                                   double* impulse) {
  for (std::size_t k = range.begin; k < range.end; ++k) {
    const std::size_t c = index_of(list[k]);
    if (start_[c] < 0) pack(c);
    if (elastic_start_[c] < 0) pack_elastic(c);
  }
  operations_ = 0;
  groups_.begin(range.group, y);
  for (int pass = 0; pass < range.passes; ++pass) {
    for (std::size_t k = range.begin; k < range.end; ++k) {
      update(switches, index_of(list[k]), y, impulse + 3 * k);
    }
  }
  return operations_ + groups_.finish({&range.group, 1}, y, 1);
}

}  // namespace tetwarp
