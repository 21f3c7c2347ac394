/// @file simulated_device.hpp
/// SimulatedDevice: a device whose motion is in a file.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "host/view/devices/input_device.hpp"

namespace tetwarp::view {

/// One line is read at a time, however often that is: the same lines do the same.
class SimulatedDevice : public InputDevice {
 public:
  /// @param path  lines "seconds, move x y z, turn x y z, grabs 0 or 1", and of a wand "place x y
  ///              z, rotation qw qx qy qz, probes 0 or 1" in them
  /// @throws IoError  naming the file and the line
  explicit SimulatedDevice(const std::string& path);

  std::optional<DeviceSpan> read() override;
  bool is_simulated() const override { return true; }

 private:
  std::vector<DeviceSpan> spans_;
  std::size_t next_ = 0;
};

}  // namespace tetwarp::view
