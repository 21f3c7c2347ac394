/// @file point_run.hpp
/// Moves points on an executor.
#pragma once
#include <cstdint>

#include "host/base/index_space.hpp"
#include "host/base/point_backend.hpp"
#include "host/warp/point_search.hpp"
#include "kernels/warp/point_move.hpp"

namespace tetwarp {

template <class Exec>
void move_points(Exec& exec, const PointPlan& plan, MappedPoints& result) {
  const IndexFromWorld map = index_from_world(plan.grid);
  const PointSearch search = make_point_search(map, plan.from, plan.mesh.tets);
  const auto count = [](const auto& list) { return static_cast<std::int64_t>(list.size()); };
  const auto numbers = [](const auto& list) { return list.empty() ? nullptr : list[0].data(); };
  typename Exec::template Vector<std::int64_t> first, straightened;
  typename Exec::template Vector<std::int32_t> listed, tets, hexes, curves, owners;
  typename Exec::template Vector<PointPlanes> planes;
  typename Exec::template Vector<Node> rounded;
  typename Exec::template Vector<double> from, to, points;
  exec.put(numbers(result.points), 3 * count(result.points), points);
  exec.resize(owners, count(result.points));
  PointMoveOp op{};
  op.map = map;
  op.cubes = search.cubes;
  op.cubes.first = exec.input(search.first.data(), count(search.first), first);
  op.cubes.tets = exec.input(search.listed.data(), count(search.listed), listed);
  op.planes = exec.input(search.planes.data(), count(search.planes), planes);
  op.rounded = exec.input(search.rounded.data(), count(search.rounded), rounded);
  op.tets = exec.input(numbers(plan.mesh.tets), 4 * count(plan.mesh.tets), tets);
  op.hexes = {exec.input(numbers(plan.mesh.hexes), 8 * count(plan.mesh.hexes), hexes),
              count(plan.mesh.tets) - tets_per_hex * count(plan.mesh.hexes)};
  op.curves = {exec.input(numbers(plan.mid_nodes), 6 * count(plan.mid_nodes), curves)};
  exec.put(&result.straightened, 1, straightened);
  op.straightened = exec.view(straightened);
  op.nodes = {exec.input(numbers(plan.from), 3 * count(plan.from), from),
              exec.input(numbers(plan.to), 3 * count(plan.to), to)};
  op.points = exec.view(points);
  op.owners = exec.view(owners);
  point_move(exec, op);
  if (result.points.empty()) return;
  exec.get(View<const double>(op.points), result.points[0].data());
  exec.get(View<const std::int32_t>(op.owners), result.owners.data());
  exec.get(View<const std::int64_t>(op.straightened), &result.straightened);
}

}  // namespace tetwarp
