/// @file device_calls.hpp
/// The calls that the host made to the emulated device, counted and located by name.
#pragma once
#include <algorithm>
#include <cstdint>
#include <ostream>
#include <set>
#include <string>
#include <utility>

#include "kernels/exec/launch.hpp"

namespace tetwarp::test {

using DeviceCall = simt::ApiCall;

class DeviceCalls {
 public:
  explicit DeviceCalls(std::string calls) : calls_(std::move(calls)) {}

  std::int64_t count(DeviceCall call) const {
    return std::count(calls_.begin(), calls_.end(), static_cast<char>(call));
  }

  /// What the device has to do: launches (those within graphs one by one), copies, fills, records
  /// of events.
  std::int64_t operations() const {
    std::int64_t sum = 0;
    for (const DeviceCall call :
         {DeviceCall::launch, DeviceCall::copy_to_device, DeviceCall::copy_to_host,
          DeviceCall::copy_within, DeviceCall::fill, DeviceCall::record}) {
      sum += count(call);
    }
    return sum;
  }

  /// Position of the first such call; the number of all calls where there is none.
  std::int64_t first(DeviceCall call) const {
    return std::find(calls_.begin(), calls_.end(), static_cast<char>(call)) - calls_.begin();
  }

  /// Position of the last such call, -1 where there is none.
  std::int64_t last(DeviceCall call) const {
    return calls_.rend() - std::find(calls_.rbegin(), calls_.rend(), static_cast<char>(call)) - 1;
  }

  bool operator==(const DeviceCalls&) const = default;

  /// One letter per call, as DeviceCall defines them.
  friend std::ostream& operator<<(std::ostream& out, const DeviceCalls& calls) {
    return out << calls.calls_;
  }

 private:
  std::string calls_;
};

/// The calls since the last time this was called.
inline DeviceCalls take_calls() {
  return DeviceCalls(simt::Device::only().take_calls());
}

/// The different launches since the last time this was called.
inline std::set<simt::LaunchShape> take_launches() {
  return simt::Device::only().take_launches();
}

/// The bytes that crossed between host and device since the last time this was called.
inline simt::CopiedBytes take_copied() {
  return simt::Device::only().take_copied();
}

}  // namespace tetwarp::test
