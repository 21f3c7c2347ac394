/// @file map_points_cpu.cpp
/// Back end cpu of map_points().
#include <tetwarp/map_points.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>

#include "host/exec/exec_cpu.hpp"
#include "host/warp/point_run.hpp"
#include "kernels/base/key_value.hpp"

namespace tetwarp {
namespace {
/// Moves points [begin, end). Where they jump from cube to cube in a mesh beyond the caches, they
/// are taken in the order of the cubes, so that memory that is read is near what was read before.
void move_part(const PointMoveOp& op, std::int64_t begin, std::int64_t end) {
  constexpr std::int64_t far = 64;       // cubes
  constexpr std::int64_t cached = 8192;  // tetrahedra whose planes take a megabyte
  if (op.planes.size <= cached) {
    for (std::int64_t p = begin; p < end; ++p) op(p);
    return;
  }
  HostBuffer<KeyValue> buffer;
  buffer.reserve(end - begin);
  const View<KeyValue> order = buffer.view(end - begin);
  std::int64_t last = 0, jumps = 0;
  for (std::int64_t p = begin; p < end; ++p) {
    const std::int64_t cube = std::max<std::int64_t>(0, op.cubes.cube_of(op.rounded_point(p)));
    jumps += cube > last + far || cube < last - far;
    last = cube;
    order[p - begin] = make_key_value(cube, p - begin);
  }
  if (jumps > (end - begin) / 4) {
    const auto bits = std::bit_width(static_cast<std::uint64_t>(op.cubes.count()));
    PairSort().sort(1, order, static_cast<int>(bits));
  }
  for (std::int64_t n = 0; n < order.size; ++n) op(begin + value_of(order[n]));
}
}  // namespace

/// As on other executors, part by part.
void point_move(CpuExec& exec, const PointMoveOp& op) {
  const std::int64_t count = op.owners.size;
  // Of a larger mesh more points, so that several come to each cube.
  const std::int64_t part_size = std::int64_t{1} << (op.planes.size > 1 << 17 ? 18 : 16);
  const std::int64_t parts = (count + part_size - 1) / part_size;
  if (count <= part_size / 4) return exec.for_each("points/move", count, op);
  parallel_tasks(exec.threads(), parts, [&](std::int64_t part) {
    move_part(op, part * part_size, std::min((part + 1) * part_size, count));
  });
}

void move_points_cpu(const PointPlan& plan, MappedPoints& result) {
  CpuExec exec(plan.threads, StageClocks::off);
  move_points(exec, plan, result);
}

}  // namespace tetwarp
