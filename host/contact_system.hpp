/// @file contact_system.hpp
/// The numbers of a contact problem in the order of its structure, as the stages read them.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact_structure.hpp"
#include "kernels/contact_law.hpp"
#include "kernels/contact_sweep.hpp"

namespace tetwarp {

template <class T>
struct ContactSystem {
  std::vector<ContactConstants<T>> constants;  ///< [slots]
  std::vector<T> free_velocity;                ///< q, [3 slots]

  // Global form.
  std::vector<T> offset;     ///< w, [3 slots]
  std::vector<T> load;       ///< b, [dofs]
  std::vector<T> jacobian;   ///< by pairs
  std::vector<T> response;   ///< A^-1 J^T by pairs; of coupled islands omega D^-1 J^T
  std::vector<T> inverse;    ///< D^-1: inverses of the diagonal blocks
  std::vector<T> system;     ///< A by blocks
  std::vector<T> body_free;  ///< A^-1 b, [dofs]; of coupled islands not set

  // Local form.
  std::vector<T> delassus;  ///< W by blocks

  DelassusView<T> delassus_view(const ContactStructure& structure) const;
  BodiesView<T> bodies_view(const ContactStructure& structure) const;
  ContactNumbers<T> numbers(const ContactStructure& structure) const;
};

/// What was left out of a system because it cannot matter.
struct ContactSavings {
  std::int64_t rows = 0;
  std::int64_t springs = 0;
};

/// The system of a problem, in float64.
/// @param structure  of this problem or one of the same pattern
/// @param savings    out
void fill_system(const ContactProblem& problem,
                 const ContactOptions& options,
                 const ContactStructure& structure,
                 ContactSystem<double>& system,
                 ContactSavings& savings);

/// The same numbers, rounded.
ContactSystem<float> make_float32(const ContactSystem<double>& system);

template <class T>
DelassusView<T> ContactSystem<T>::delassus_view(const ContactStructure& structure) const {
  return {view_of(structure.delassus_row), view_of(structure.delassus_column), view_of(delassus),
          view_of(free_velocity)};
}

template <class T>
BodiesView<T> ContactSystem<T>::bodies_view(const ContactStructure& structure) const {
  return {structure.pairs(), view_of(jacobian), view_of(response), view_of(offset)};
}

template <class T>
ContactNumbers<T> ContactSystem<T>::numbers(const ContactStructure& structure) const {
  ContactNumbers<T> numbers;
  numbers.is_local = structure.is_local;
  numbers.constants = view_of(constants);
  numbers.free_velocity = view_of(free_velocity);
  if (structure.is_local) {
    numbers.delassus = delassus_view(structure);
    return numbers;
  }
  numbers.bodies = bodies_view(structure);
  numbers.block_contacts = structure.block_contacts();
  numbers.body_free = view_of(body_free);
  numbers.system = structure.system(view_of(system));
  numbers.load = view_of(load);
  numbers.diagonal_value = view_of(structure.diagonal_value);
  numbers.inverse_start = view_of(structure.inverse_start);
  numbers.inverse = view_of(inverse);
  return numbers;
}

}  // namespace tetwarp
