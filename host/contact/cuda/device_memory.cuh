/// @file device_memory.cuh
/// A contact problem in the memory of a device: indices, what the problem gives, what a solve
/// changes.
#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <initializer_list>
#include <utility>
#include <vector>

#include "kernels/contact/contact_adhesion.hpp"
#include "kernels/contact/contact_grid.cuh"
#include "kernels/contact/contact_indices.hpp"
#include "kernels/contact/contact_methods.hpp"
#include "kernels/contact/contact_system.hpp"

namespace tetwarp {

/// Arrays of the host, copied to a device in the same order time after time.
class DeviceArrays {
 public:
  void restart() { used_ = 0; }

  template <class T>
  View<const T> put(const GridContactExec& exec, View<const T> host) {
    if (used_ == arrays_.size()) arrays_.emplace_back();
    DeviceVector<std::byte>& array = arrays_[used_++];
    const auto bytes = host.size * static_cast<std::int64_t>(sizeof(T));
    exec.put(reinterpret_cast<const std::byte*>(host.data), bytes, array);
    return {reinterpret_cast<const T*>(view_of(array).data), host.size};
  }

 private:
  std::deque<DeviceVector<std::byte>> arrays_;
  std::size_t used_ = 0;
};

/// The same indices there.
inline ContactIndices indices_on_device(const GridContactExec& exec,
                                        const ContactIndices& host,
                                        DeviceArrays& arrays) {
  arrays.restart();
  ContactIndices there = host;
  const auto move = [&](auto& view) { view = arrays.put(exec, view); };
  move(there.contact_of_slot);
  move(there.color_start);
  move(there.delassus_row);
  move(there.delassus_column);
  move(there.delassus_target);
  move(there.delassus_diagonal);
  move(there.pairs.pair_start);
  move(there.pairs.block);
  move(there.pairs.value_start);
  move(there.pairs.dof_start);
  move(there.block_contacts.start);
  move(there.block_contacts.contact);
  move(there.block_contacts.value);
  move(there.dof_of_place);
  move(there.block_is_coupled);
  move(there.inverse_start);
  move(there.diagonal_value);
  move(there.jacobian_target);
  move(there.system_row);
  move(there.system_column);
  move(there.system_value);
  move(there.system_target);
  return there;
}

/// The same numbers there.
/// @param members  of the struct: views to copy
template <class Numbers>
Numbers numbers_on_device(const GridContactExec& exec,
                          const Numbers& host,
                          std::initializer_list<View<const double> Numbers::*> members,
                          DeviceArrays& arrays) {
  arrays.restart();
  Numbers there = host;
  for (const auto member : members) there.*member = arrays.put(exec, host.*member);
  return there;
}

inline ContactInput input_on_device(const GridContactExec& exec,
                                    const ContactInput& host,
                                    DeviceArrays& arrays) {
  using In = ContactInput;
  return numbers_on_device(
      exec, host,
      {&In::matrix, &In::jacobian, &In::load, &In::given_velocity, &In::friction, &In::area,
       &In::stiffness, &In::tangential_stiffness, &In::intensity, &In::gap},
      arrays);
}

inline AdhesionViews adhesion_on_device(const GridContactExec& exec,
                                        const AdhesionViews& host,
                                        DeviceArrays& arrays) {
  using In = AdhesionViews;
  return numbers_on_device(
      exec, host,
      {&In::area, &In::stiffness, &In::tangential_stiffness, &In::intensity, &In::gap, &In::energy,
       &In::viscosity, &In::bonding_rate, &In::saturation_pressure, &In::impulse, &In::velocity},
      arrays);
}

/// What a solve changes and works with.
template <class T>
struct DeviceState {
  DeviceVector<T> impulse;                    ///< [3 slots]
  DeviceVector<T> body_velocity;              ///< [dofs]
  DeviceVector<std::int32_t> skipped_visits;  ///< [slots], or empty

  /// Velocities without impulses, which are not touched; nothing calm.
  void reset(GridContactExec& exec, const ContactNumbers<T>& numbers, bool freezes) {
    velocity_.resize(numbers.free_velocity.size);
    exec.copy("contact/setup", numbers.free_velocity, view_of(velocity_));
    body_velocity.resize(numbers.body_free.size);
    exec.copy("contact/setup", numbers.body_free, view_of(body_velocity));
    exec.resize(unchanged_visits_, freezes ? numbers.constants.size : 0);
    exec.resize(skipped_visits, freezes ? numbers.constants.size : 0);
  }

  ContactState<T> state() {
    return {view_of(impulse),           view_of(velocity_),     view_of(body_velocity), {},
            view_of(unchanged_visits_), view_of(skipped_visits)};
  }

  /// Memory that methods work with.
  MethodWork<T> work() {
    const std::int64_t rows = velocity_.view().size;
    for (DeviceVector<T>* values : {&before_, &best_}) values->resize(rows);
    weights_.resize(rows);
    mixed_.resize(MethodWork<T>::columns * rows);
    metric_.resize(rows / 3);
    return {view_of(weights_), view_of(before_), view_of(best_), view_of(mixed_), view_of(metric_)};
  }

 private:
  DeviceVector<T> velocity_, before_, best_, mixed_;
  DeviceVector<double> weights_;
  DeviceVector<ContactConstants<T>> metric_;
  DeviceVector<std::uint8_t> unchanged_visits_;
};

}  // namespace tetwarp
