/// @file device_memory.cuh
/// Copies of host arrays in the memory of a device.
#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <initializer_list>
#include <utility>
#include <vector>

#include "kernels/contact/contact_adhesion.hpp"
#include "kernels/contact/contact_fill.hpp"
#include "kernels/exec/exec_cuda.cuh"

namespace tetwarp {

/// Copies host arrays to a device. Buffers are reused: after restart() the k-th put() overwrites
/// the k-th array of the round before.
class DeviceArrays {
 public:
  void restart() { used_ = 0; }

  template <class T>
  View<const T> put(CudaExec& exec, View<const T> host) {
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

/// The same struct with views of copies on the device.
/// @param members  the views to copy
template <class Numbers>
Numbers numbers_on_device(CudaExec& exec,
                          const Numbers& host,
                          std::initializer_list<View<const double> Numbers::*> members,
                          DeviceArrays& arrays) {
  arrays.restart();
  Numbers result = host;
  for (const auto member : members) result.*member = arrays.put(exec, host.*member);
  return result;
}

inline ContactInput input_on_device(CudaExec& exec,
                                    const ContactInput& host,
                                    DeviceArrays& arrays) {
  using In = ContactInput;
  ContactInput result = numbers_on_device(
      exec, host,
      {&In::matrix, &In::jacobian, &In::load, &In::given_velocity, &In::friction, &In::area,
       &In::stiffness, &In::tangential_stiffness, &In::intensity, &In::gap},
      arrays);
  if (host.row_kind.size == 0) return result;
  result.row_kind = arrays.put(exec, host.row_kind);
  result.row_contact = arrays.put(exec, host.row_contact);
  result.torsion = arrays.put(exec, host.torsion);
  return result;
}

inline AdhesionViews adhesion_on_device(CudaExec& exec,
                                        const AdhesionViews& host,
                                        DeviceArrays& arrays) {
  using In = AdhesionViews;
  return numbers_on_device(
      exec, host,
      {&In::area, &In::stiffness, &In::tangential_stiffness, &In::intensity, &In::gap, &In::energy,
       &In::viscosity, &In::bonding_rate, &In::saturation_pressure, &In::impulse, &In::velocity,
       &In::pressing, &In::velocity_offset},
      arrays);
}

}  // namespace tetwarp
