/// @file staged_arrays.cuh
/// Several arrays of the host in memory of a device, by one copy.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <tuple>
#include <utility>
#include <vector>

#include "kernels/exec/device_vector.cuh"

namespace tetwarp {

class StagedArrays {
 public:
  /// @param exec    with put()
  /// @param arrays  of the host; not read after the call
  /// @returns       their views on the device, valid until the next call
  template <class Exec, class... T>
  std::tuple<View<const T>...> put(Exec& exec, const std::vector<T>&... arrays) {
    std::int64_t size = 0;
    host_.resize(static_cast<std::size_t>((std::int64_t{0} + ... + room_for(arrays))));
    (append(arrays, size), ...);
    exec.put(host_.data(), size, device_);
    const std::byte* next = view_of(std::as_const(device_)).data;
    // Initializers of braces are evaluated in their order.
    return std::tuple<View<const T>...>{take(arrays, next)...};
  }

 private:
  template <class T>
  static std::int64_t room_for(const std::vector<T>& array) {
    return static_cast<std::int64_t>((array.size() * sizeof(T) + 15) / 16 * 16);
  }
  template <class T>
  void append(const std::vector<T>& array, std::int64_t& size) {
    if (!array.empty()) std::memcpy(host_.data() + size, array.data(), array.size() * sizeof(T));
    size += room_for(array);
  }
  template <class T>
  static View<const T> take(const std::vector<T>& array, const std::byte*& next) {
    const View<const T> view{reinterpret_cast<const T*>(next),
                             static_cast<std::int64_t>(array.size())};
    next += room_for(array);
    return view;
  }

  std::vector<std::byte> host_;
  DeviceVector<std::byte> device_;
};

}  // namespace tetwarp
