/// @file deform_mesh.cpp
/// Procedural deformations, each a displacement as a function of the rest position.
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

/// Box of the rest positions and the axes of a deformation: `along`, then the two across it in
/// cyclic order.
struct Frame {
  Point3 low;
  Point3 size;
  Point3 center;
  std::size_t along;
  std::size_t side;
  std::size_t other;

  /// 0 at the low end of the box, 1 at the high end.
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

/// Displacement of a turn by `angle` about the line through the box's center along the axis.
Point3 turn(const Frame& frame, const Point3& x, double angle) {
  const double side = x[frame.side] - frame.center[frame.side];
  const double other = x[frame.other] - frame.center[frame.other];
  const double less = std::cos(angle) - 1;
  Point3 moved{0, 0, 0};
  moved[frame.side] = less * side - std::sin(angle) * other;
  moved[frame.other] = std::sin(angle) * side + less * other;
  return moved;
}

/// The ends turn by half the angle each, in opposite directions.
Point3 twist(const Frame& frame, const Point3& x, double angle) {
  return turn(frame, x, angle * (frame.share(x, frame.along) - 0.5));
}

/// Lays the axis on an arc of `angle` whose center is on the far `side`. The line that keeps its
/// length is the box's middle or, where the box is too thick for that, one nearer to the arc's
/// center, so that the inside of the bend does not fold.
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

/// A wave as long as the box that travels from the high to the low end, two beats from time 0 to 1;
/// the low end beats by a tenth of the length, the high end by a hundredth. Every cross-section
/// moves sideways as a whole, so that volume is kept.
Point3 swim(const Frame& frame, const Point3& x, double amount, double time) {
  const double from_head = 1 - frame.share(x, frame.along);
  const double growth = 0.1 + 0.9 * from_head * from_head;
  const double onset = time * time * (3 - 2 * time);
  Point3 moved{0, 0, 0};
  moved[frame.side] = 0.1 * amount * frame.size[frame.along] * onset * growth *
                      std::sin(2 * pi * (from_head - 2 * time));
  return moved;
}

/// A sum of sine waves in the box's shares; wave vectors and phases come from the seed. At strength
/// 1 no wave sum passes a twentieth of the box, and no gradient passes 0.05 * 2 pi * 3 < 1 in the
/// Frobenius norm, so that nothing is turned inside out.
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
  if (time == 0) return positions;  // bit for bit, the sign of zeros included
  const Frame frame = frame_of(mesh.rest_positions, options.axis);
  for (Point3& x : positions) {
    const Point3 moved = displacement(frame, x, options, time);
    for (std::size_t d = 0; d < 3; ++d) x[d] += moved[d];
  }
  return positions;
}

}  // namespace tetwarp
