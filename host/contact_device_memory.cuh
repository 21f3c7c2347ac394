/// @file contact_device_memory.cuh
/// A contact problem in the memory of a device: indices, numbers, what a solve changes.
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "host/contact_structure.hpp"
#include "host/contact_system.hpp"
#include "kernels/contact_grid.cuh"
#include "kernels/contact_methods.hpp"

namespace tetwarp {

/// Puts a vector there.
template <class T>
View<const T> put_there(const GridContactExec& exec,
                        const std::vector<T>& host,
                        DeviceVector<T>& there) {
  exec.put(host.data(), static_cast<std::int64_t>(host.size()), there);
  return view_of(std::as_const(there));
}

/// The index arrays of a structure.
class DeviceIndices {
 public:
  void put(const GridContactExec& exec, const ContactStructure& s) {
    put_there(exec, s.color_start, color_start_);
    if (s.is_local) {
      delassus_row = put_there(exec, s.delassus_row, delassus_row_);
      delassus_column = put_there(exec, s.delassus_column, delassus_column_);
      return;
    }
    const View<const std::int64_t> dof_start = put_there(exec, s.dof_start, dof_start_);
    pairs = {put_there(exec, s.pair_start, pair_start_), put_there(exec, s.pair_block, pair_block_),
             put_there(exec, s.pair_value, pair_value_), dof_start};
    block_contacts = {put_there(exec, s.block_start, block_start_),
                      put_there(exec, s.block_contact, block_contact_),
                      put_there(exec, s.block_value, block_value_)};
    system_row = put_there(exec, s.system_row, system_row_);
    system_column = put_there(exec, s.system_column, system_column_);
    system_value = put_there(exec, s.system_value, system_value_);
    diagonal_value = put_there(exec, s.diagonal_value, diagonal_value_);
    inverse_start = put_there(exec, s.inverse_start, inverse_start_);
  }

  View<const std::int64_t> color_start() const { return view_of(color_start_); }

  PairView pairs;
  BlockContacts block_contacts;
  View<const std::int64_t> delassus_row, system_row, system_value, diagonal_value, inverse_start;
  View<const std::int32_t> delassus_column, system_column;

 private:
  DeviceVector<std::int64_t> color_start_, delassus_row_, dof_start_, pair_start_, pair_value_,
      block_start_, block_value_, system_row_, system_value_, diagonal_value_, inverse_start_;
  DeviceVector<std::int32_t> delassus_column_, pair_block_, block_contact_, system_column_;
};

/// The numbers of a system, and what a solve changes.
template <class T>
struct DeviceSystem {
  ContactNumbers<T> numbers;
  DeviceVector<T> impulse;              ///< [3 slots]
  DeviceVector<std::int32_t> left_out;  ///< [slots], or empty

  void put(const GridContactExec& exec,
           const ContactStructure& structure,
           const DeviceIndices& indices,
           const ContactSystem<T>& system) {
    numbers = {};
    numbers.is_local = structure.is_local;
    numbers.constants = put_there(exec, system.constants, constants_);
    numbers.free_velocity = put_there(exec, system.free_velocity, free_velocity_);
    if (structure.is_local) {
      numbers.delassus = {indices.delassus_row, indices.delassus_column,
                          put_there(exec, system.delassus, delassus_), numbers.free_velocity};
      body_velocity_.resize(0);
      return;
    }
    numbers.bodies = {indices.pairs, put_there(exec, system.jacobian, jacobian_),
                      put_there(exec, system.response, response_),
                      put_there(exec, system.offset, offset_)};
    numbers.block_contacts = indices.block_contacts;
    numbers.body_free = put_there(exec, system.body_free, body_free_);
    numbers.system = {indices.system_row,      indices.system_column,
                      indices.system_value,    put_there(exec, system.system, system_),
                      indices.pairs.dof_start, structure.has_only_nodes};
    numbers.load = put_there(exec, system.load, load_);
    numbers.diagonal_value = indices.diagonal_value;
    numbers.inverse_start = indices.inverse_start;
    numbers.inverse = put_there(exec, system.inverse, inverse_);
  }

  /// Velocities without impulses, nothing calm.
  void reset(GridContactExec& exec, bool freezes) {
    velocity_.resize(numbers.free_velocity.size);
    exec.copy("contact/setup", numbers.free_velocity, view_of(velocity_));
    body_velocity_.resize(numbers.body_free.size);
    exec.copy("contact/setup", numbers.body_free, view_of(body_velocity_));
    exec.resize(calm_, freezes ? numbers.constants.size : 0);
    exec.resize(left_out, freezes ? numbers.constants.size : 0);
  }

  ContactState<T> state() {
    return {view_of(impulse), view_of(velocity_), view_of(body_velocity_), {},
            view_of(calm_),   view_of(left_out)};
  }

  /// Memory that methods work with.
  MethodWork<T> work() {
    const std::int64_t slots = numbers.constants.size;
    for (DeviceVector<T>* rows : {&before_, &best_}) rows->resize(3 * slots);
    weights_.resize(3 * slots);
    mixed_.resize(MethodWork<T>::columns * 3 * slots);
    metric_.resize(slots);
    return {view_of(weights_), view_of(before_), view_of(best_), view_of(mixed_), view_of(metric_)};
  }

 private:
  DeviceVector<ContactConstants<T>> constants_, metric_;
  DeviceVector<T> free_velocity_, delassus_, jacobian_, response_, offset_, body_free_, system_,
      load_, inverse_, velocity_, body_velocity_, before_, best_, mixed_;
  DeviceVector<double> weights_;
  DeviceVector<std::uint8_t> calm_;
};

}  // namespace tetwarp
