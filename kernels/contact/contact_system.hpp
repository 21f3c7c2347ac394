/// @file contact_system.hpp
/// Memory for the numbers of a contact problem in the order of its structure, for any executor.
#pragma once
#include <cstdint>

#include "kernels/contact/contact_fill.hpp"
#include "kernels/contact/vector_bodies.hpp"

namespace tetwarp {

/// The numbers of a problem; only the vectors of its form are used.
template <class Exec, class T>
struct SystemMemory {
  template <class U>
  using Vector = typename Exec::template Vector<U>;

  Vector<ContactConstants<T>> constants;  ///< [slots]
  Vector<T> free_velocity;                ///< q, [3 slots]

  // Global form.
  Vector<T> offset;     ///< w, [3 slots]
  Vector<T> load;       ///< b, [dofs]
  Vector<T> jacobian;   ///< by pairs
  Vector<T> response;   ///< A^-1 J^T by pairs; in coupled islands omega D^-1 J^T
  Vector<T> inverse;    ///< D^-1: inverses of the diagonal blocks
  Vector<T> system;     ///< A by blocks
  Vector<T> body_free;  ///< A^-1 b, [dofs]; in coupled islands zero

  // Local form.
  Vector<T> delassus;  ///< W by blocks

  /// Sets the sizes for a problem; all numbers become zero.
  void resize(const Exec& exec, const ContactIndices& indices) {
    const bool is_local = indices.is_local;
    const auto global = [&](std::int64_t size) { return is_local ? 0 : size; };
    exec.make_zeros(constants, indices.slots());
    exec.make_zeros(free_velocity, 3 * indices.slots());
    exec.make_zeros(offset, global(3 * indices.slots()));
    exec.make_zeros(load, global(indices.dofs()));
    exec.make_zeros(jacobian, global(indices.jacobian_size));
    exec.make_zeros(response, global(indices.jacobian_size));
    exec.make_zeros(inverse, global(indices.inverse_size));
    exec.make_zeros(system, global(indices.system_size));
    exec.make_zeros(body_free, global(indices.dofs()));
    exec.make_zeros(delassus, is_local ? 9 * indices.delassus_column.size : 0);
  }

  /// The views that fill_numbers() writes.
  SystemViews<T> views() {
    return {view_of(constants), view_of(free_velocity), view_of(offset),  view_of(load),
            view_of(jacobian),  view_of(response),      view_of(inverse), view_of(system),
            view_of(body_free), view_of(delassus)};
  }

  /// The views that the other stages read.
  ContactNumbers<T> numbers(const ContactIndices& indices) const {
    ContactNumbers<T> numbers;
    numbers.is_local = indices.is_local;
    numbers.constants = view_of(constants);
    numbers.free_velocity = view_of(free_velocity);
    if (indices.is_local) {
      numbers.delassus = {indices.delassus_row, indices.delassus_column, view_of(delassus),
                          numbers.free_velocity};
      return numbers;
    }
    numbers.bodies = {indices.pairs, view_of(jacobian), view_of(response), view_of(offset)};
    numbers.block_contacts = indices.block_contacts;
    numbers.body_free = view_of(body_free);
    numbers.system = {indices.system_row, indices.system_column,   indices.system_value,
                      view_of(system),    indices.pairs.dof_start, indices.has_only_nodes};
    numbers.load = view_of(load);
    numbers.diagonal_value = indices.diagonal_value;
    numbers.inverse_start = indices.inverse_start;
    numbers.inverse = view_of(inverse);
    return numbers;
  }
};

/// Converts a system to another precision.
/// @param to  resized
template <class Exec, class To, class From>
void convert_system(Exec& exec,
                    const ContactIndices& indices,
                    SystemMemory<Exec, From>& from,
                    SystemMemory<Exec, To>& to) {
  to.resize(exec, indices);
  const SystemViews<From> in = from.views();
  const SystemViews<To> out = to.views();
  exec.for_each("contact/setup", in.constants.size,
                ConvertConstantsOp<To, From>{in.constants, out.constants});
  const auto one = [&](View<const From> source, View<To> target) { convert(exec, source, target); };
  one(in.free_velocity, out.free_velocity);
  one(in.offset, out.offset);
  one(in.load, out.load);
  one(in.jacobian, out.jacobian);
  one(in.response, out.response);
  one(in.inverse, out.inverse);
  one(in.system, out.system);
  one(in.body_free, out.body_free);
  one(in.delassus, out.delassus);
}

}  // namespace tetwarp
