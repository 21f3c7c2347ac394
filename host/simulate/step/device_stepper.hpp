/// @file device_stepper.hpp
/// DeviceStepper: what a BodyStepper does beyond its interface where a device has the state.
#pragma once
#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

class ResidentContacts;
class ResidentState;
class ResidentSurfaces;
class ResidentTwoLevel;

/// Its parts read the state and the system of a step in memory of the device.
class DeviceStepper : public BodyStepper {
 public:
  DeviceStepper* on_device() final { return this; }
  /// Reads and keeps the state where it is.
  virtual ResidentState& resident_state() = 0;
  /// Moves surfaces.
  virtual ResidentSurfaces& resident_surfaces() = 0;
  /// Builds contact problems.
  virtual ResidentContacts& resident_contacts() = 0;
  /// Solves contacts of deformable and coupled bodies.
  virtual ResidentTwoLevel& resident_two_level() = 0;
};

}  // namespace tetwarp
