/// @file deform_mesh.cpp
/// Procedural deformations: displacements as functions of the rest position.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <string>
#include <tetwarp/make.hpp>
#include <vector>

#include "host/base/counter_hash.hpp"

namespace tetwarp {
namespace {
using std::numbers::pi;

/// Box of the rest positions, and the axes of a deformation: `along` is its axis, `side` and
/// `other` follow in cyclic order.
struct Frame {
  Point3 low;
  Point3 size;
  Point3 center;
  std::size_t along;
  std::size_t side;
  std::size_t other;

  /// Position within the box along an axis: 0 at the low end, 1 at the high end.
  double share(const Point3& x, std::size_t axis) const {
    return size[axis] > 0 ? (x[axis] - low[axis]) / size[axis] : 0.5;
  }
};

Frame frame_of(const std::vector<Point3>& positions, int axis) {
  Point3 low = positions.front();
  Point3 high = low;
  for (const Point3& x : positions) {
    for (std::size_t d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], x[d]);
      high[d] = std::max(high[d], x[d]);
    }
  }
  const auto along = static_cast<std::size_t>(axis);
  Frame frame{low, {}, {}, along, (along + 1) % 3, (along + 2) % 3};
  for (std::size_t d = 0; d < 3; ++d) {
    frame.size[d] = high[d] - low[d];
    frame.center[d] = low[d] + 0.5 * frame.size[d];
  }
  return frame;
}

/// Displacement of a rotation by `angle` about the axis through the center of the box [radian].
Point3 turn(const Frame& frame, const Point3& x, double angle) {
  const double side = x[frame.side] - frame.center[frame.side];
  const double other = x[frame.other] - frame.center[frame.other];
  const double less = std::cos(angle) - 1;
  Point3 moved{0, 0, 0};
  moved[frame.side] = less * side - std::sin(angle) * other;
  moved[frame.other] = std::sin(angle) * side + less * other;
  return moved;
}

/// Rotates the ends by half the angle each, in opposite directions.
Point3 twist(const Frame& frame, const Point3& x, double angle) {
  return turn(frame, x, angle * (frame.share(x, frame.along) - 0.5));
}

/// Bends the axis to an arc of `angle`, with the center at positive `side`. The line that keeps its
/// length is the middle of the box; in thicker boxes the radius is larger, so that the inside of
/// the bend does not fold.
Point3 bend(const Frame& frame, const Point3& x, double angle) {
  if (angle == 0) return {0, 0, 0};
  const double length = frame.size[frame.along];
  const double radius =
      std::copysign(std::max(length / std::abs(angle), 0.75 * frame.size[frame.side]), angle);
  const double side = x[frame.side] - frame.center[frame.side];
  const double along = x[frame.along] - frame.center[frame.along];
  const double turned = angle * (frame.share(x, frame.along) - 0.5);
  // 1 - cos t = 2 sin^2(t / 2), without cancellation for a slight bend.
  const double half_sine = std::sin(0.5 * turned);
  Point3 moved{0, 0, 0};
  moved[frame.along] = (radius - side) * std::sin(turned) - along;
  moved[frame.side] = (radius - side) * 2 * half_sine * half_sine;
  return moved;
}

/// A wave of the length of the box that travels from the high to the low end, two periods from time
/// 0 to 1. Its amplitude is a tenth of the length at the low end and a hundredth at the high end.
/// Every cross-section moves sideways as a whole, so that volume is preserved.
Point3 swim(const Frame& frame, const Point3& x, double amount, double time) {
  const double from_head = 1 - frame.share(x, frame.along);
  const double growth = 0.1 + 0.9 * from_head * from_head;
  const double onset = time * time * (3 - 2 * time);
  Point3 moved{0, 0, 0};
  moved[frame.side] = 0.1 * amount * frame.size[frame.along] * onset * growth *
                      std::sin(2 * pi * (from_head - 2 * time));
  return moved;
}

/// A sum of sine waves of the position within the box; wave vectors and phases depend on the seed.
/// At strength 1 the displacement is at most a twentieth of the box and the Frobenius norm of its
/// gradient at most 0.05 * 2 pi * 3 < 1, so that nothing is inverted.
Point3 wobble(const Frame& frame, const Point3& x, std::uint64_t seed, double strength) {
  constexpr std::uint64_t wave_count = 4;
  Point3 moved{0, 0, 0};
  for (std::size_t d = 0; d < 3; ++d) {
    double sum = 0;
    for (std::uint64_t wave = 0; wave < wave_count; ++wave) {
      const std::uint64_t counter = hash_of(seed) + 4 * (wave_count * d + wave);
      double phase = unit_of(counter + 3);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        phase += (2 * unit_of(counter + axis) - 1) * frame.share(x, axis);
      }
      sum += std::sin(2 * pi * phase);
    }
    moved[d] = 0.05 * strength * frame.size[d] * sum / wave_count;
  }
  return moved;
}

Point3 displacement(const Frame& frame,
                    const Point3& x,
                    const DeformOptions& options,
                    double time) {
  const double angle = options.amount * time * pi / 2;
  switch (options.kind) {
    case Deformation::twist:
      return twist(frame, x, angle);
    case Deformation::bend:
      return bend(frame, x, angle);
    case Deformation::swim:
      return swim(frame, x, options.amount, time);
    case Deformation::random:
      return wobble(frame, x, options.seed, options.amount * time);
    case Deformation::rotate:
      return turn(frame, x, angle);
    case Deformation::translate:
      break;
  }
  return {time * options.offset[0], time * options.offset[1], time * options.offset[2]};
}

void check_options(const DeformOptions& options, double time) {
  const std::string where = "deform_positions: ";
  if (!(time >= 0 && time <= 1)) {
    throw std::invalid_argument(where + "time " + std::to_string(time) + ", expected 0 to 1");
  }
  if (options.axis < 0 || options.axis > 2) {
    throw std::invalid_argument(where + "axis " + std::to_string(options.axis) +
                                ", expected 0, 1 or 2");
  }
  if (!std::isfinite(options.amount)) {
    throw std::invalid_argument(where + "amount is not finite");
  }
  for (const double coordinate : options.offset) {
    if (!std::isfinite(coordinate)) throw std::invalid_argument(where + "offset is not finite");
  }
}
}  // namespace

std::vector<Point3> deform_positions(const Mesh& mesh, const DeformOptions& options, double time) {
  check_mesh(mesh);
  check_options(options, time);
  std::vector<Point3> positions = mesh.rest_positions;
  if (time == 0) return positions;  // with the signs of zeros
  const Frame frame = frame_of(mesh.rest_positions, options.axis);
  for (Point3& x : positions) {
    const Point3 moved = displacement(frame, x, options, time);
    for (std::size_t d = 0; d < 3; ++d) {
      x[d] += moved[d];
      if (std::isfinite(x[d])) continue;
      throw std::invalid_argument(
          "deform_positions: amount or offset is so large that positions are not finite");
    }
  }
  return positions;
}

}  // namespace tetwarp
