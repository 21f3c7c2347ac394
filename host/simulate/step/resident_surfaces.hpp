/// @file resident_surfaces.hpp
/// ResidentSurfaces: moves surfaces in memory of the device that steps the bodies.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/simulate/model/model.hpp"
#include "kernels/base/view.hpp"

namespace tetwarp {

/// What the vertices and planes of surfaces are bound to; owns nothing. A vertex that a frame moves
/// has the frame of its body, and so has a plane.
struct SurfaceBinding {
  std::span<const ModelPoint> vertex_point;   ///< [vertices]
  std::span<const std::int32_t> vertex_body;  ///< [vertices]
  std::span<const std::int32_t> body_rigid;   ///< [bodies, then obstacles] frame, or -1
  std::span<const std::int32_t> plane_rigid;  ///< [planes] frame
  std::span<const std::int32_t> plane_body;   ///< [planes]
  std::span<const double> plane_local;        ///< [planes][6] point and unit normal in the frame
};

/// A motion of surfaces in memory of a device, as SurfaceMotion.
struct ResidentMotion {
  View<const double> start, end;              ///< [vertices][3]
  View<const double> sagitta;                 ///< [vertices]
  View<const double> plane_start, plane_end;  ///< [planes][6]
  View<const double> frames;                  ///< [bodies, then obstacles][9] center, motion, turn
};

class ResidentSurfaces {
 public:
  virtual ~ResidentSurfaces() = default;
  /// Begins a part of a step: computes places at its start from the state of the stepper.
  /// @param surfaces  the same in all calls; copied to the device in the first
  virtual void begin(const SurfaceBinding& surfaces) = 0;
  /// As frame_motion() and vertex_motion(), from the state at begin(). Returns when all has been
  /// computed.
  /// @param velocity  [block_count]; empty: those of the stepper
  /// @returns  views that are valid until the next call
  virtual ResidentMotion move(std::span<const Point3> velocity,
                              double time_step,
                              std::span<const double> fraction) = 0;
};

}  // namespace tetwarp
