/// @file resample.cpp
/// Checks the arguments of resample(), and runs its rows on host threads.
#include <tetwarp/resample.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <tetwarp/error.hpp>

#include "host/base/index_space.hpp"
#include "host/base/parallel.hpp"
#include "host/base/pixel_dispatch.hpp"
#include "host/base/warp_backend.hpp"
#include "host/exec/exec_cpu.hpp"
#include "host/warp/box_sums.hpp"
#include "host/warp/cpu/row_resample_cpu.hpp"
#include "host/warp/cpu/transform_links.hpp"
#include "host/warp/label_stages.hpp"
#include "host/warp/sources.hpp"
#include "host/warp/transform_checks.hpp"
#include "kernels/warp/row_resample.hpp"

namespace tetwarp {
namespace {
/// From indices of a grid to the world.
IndexAffine world_map(const Grid& grid) {
  IndexAffine map;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      map.linear[row][axis] = grid.direction[3 * row + axis] * grid.spacing[axis];
    }
    map.offset[row] = grid.origin[row];
  }
  return map;
}

/// From the world to indices of a grid.
IndexAffine index_map(const Grid& grid) {
  const IndexFromWorld from_world = index_from_world(grid);
  IndexAffine map;
  for (int row = 0; row < 3; ++row) {
    map.offset[row] = 0;
    for (int axis = 0; axis < 3; ++axis) {
      map.linear[row][axis] = from_world.linear[row][axis];
      map.offset[row] -= from_world.linear[row][axis] * from_world.origin[axis];
    }
  }
  return map;
}

/// From output indices to those of another grid at the same place in the world; whole-voxel shifts
/// are exact.
IndexAffine between_grids(const Grid& other, const Grid& output) {
  const IndexMap map = source_from_output(other, output);
  IndexAffine affine;
  for (std::size_t row = 0; row < 3; ++row) {
    std::copy_n(map.linear.begin() + static_cast<std::ptrdiff_t>(3 * row), 3, affine.linear[row]);
    affine.offset[row] = map.offset[row];
  }
  return affine;
}

/// @param links  of the transform, folded
ResampleMap make_map(const Grid& source,
                     const Grid& output,
                     const Transform& transform,
                     const std::vector<TransformLink>& links,
                     const ResampleOptions& options) {
  ResampleMap map{};
  map.to_source = between_grids(source, output);
  map.only_in_field = options.only_in_field;
  if (links.empty()) return map;
  map.to_first = map.to_world = world_map(output);
  const bool begins_affine = links.front().is_affine();
  if (begins_affine) map.to_first = composed(links.front().affine, map.to_world);
  if (begins_affine && links.size() == 1) {
    map.to_source = composed(index_map(source), map.to_first);
    return map;
  }
  const IndexFromWorld from_world = index_from_world(source);
  for (int row = 0; row < 3; ++row) std::copy_n(from_world.linear[row], 3, map.from_world[row]);
  const Grid& grid = *first_grid(transform);
  const TransformLink& first = links[begins_affine ? 1 : 0];
  if (links.size() == 1 && first.field.vectors != nullptr && grid == output) {
    map.field = first.field;
    return map;
  }
  map.links = {&first, std::ssize(links) - (begins_affine ? 1 : 0)};
  map.to_first_index =
      begins_affine ? composed(index_map(grid), map.to_first) : between_grids(grid, output);
  return map;
}

WarpPlan make_plan(std::span<const VolumeView> sources, const ResampleOptions& options) {
  check_sources(sources, "resample");
  WarpPlan plan;
  plan.sources.assign(sources.begin(), sources.end());
  for (const VolumeView& source : sources) {
    if (source.memory != Memory::host) throw std::invalid_argument("source: not in host memory");
  }
  plan.options.filter = options.filter;
  plan.options.label_rule = options.label_rule;
  plan.options.label_gaussian = options.label_gaussian;
  plan.options.overshoot = options.overshoot;
  if (options.label_rule == LabelRule::volume) {
    throw std::invalid_argument(
        "label rule: volume is for warps by a mesh; use linear or gaussian");
  }
  check_transforms(plan.sources, plan.options);
  const Grid& grid = sources.front().grid;
  plan.source_region = {{0, 0, 0}, grid.dims};
  plan.output_grid = options.output_grid.value_or(grid);
  check_grid(plan.output_grid, "output grid");
  return plan;
}
/// Calls work(begin, end) for parts of [0, count) on host threads.
/// @param size  what is computed between two reports
template <class Work>
void in_parts(int threads,
              std::int64_t count,
              std::int64_t size,
              const ProgressPart& progress,
              const Work& work) {
  for (std::int64_t begin = 0; begin < count; begin += size) {
    progress.report(static_cast<double>(begin) / static_cast<double>(count));
    const std::int64_t part = std::min(size, count - begin);
    const std::int64_t tasks = std::min<std::int64_t>(part, 4 * threads);
    parallel_tasks(threads, tasks, [&](std::int64_t task) {
      work(begin + part * task / tasks, begin + part * (task + 1) / tasks);
    });
  }
}
}  // namespace

std::vector<Point3> transformed(const Transform& transform, std::vector<Point3> points) {
  const std::vector<TransformLink> links = links_of(transform);
  for (Point3& point : points) {
    for (const TransformLink& link : links) link.move(point.data());
  }
  return points;
}

void resample(std::span<const VolumeView> sources,
              const Transform& transform,
              const ResampleOptions& options,
              std::span<void* const> outputs,
              const Progress& progress) {
  const std::vector<TransformLink> links = folded(links_of(transform));
  const WarpPlan plan = make_plan(sources, options);
  if (outputs.size() != sources.size() ||
      std::find(outputs.begin(), outputs.end(), nullptr) != outputs.end()) {
    throw std::invalid_argument("outputs: expected one array per source");
  }
  const int threads = thread_count(options.threads);
  CpuExec exec(threads, StageClocks::off);
  WarpSources<CpuExec> data(exec, plan);
  const Grid& output = plan.output_grid;
  const ResampleMap map = make_map(sources.front().grid, output, transform, links, options);
  const std::int64_t lines = resample_lines(output.dims.data());
  constexpr std::int64_t part_voxels = 1 << 22;  // between two reports of progress
  const std::int64_t part =
      std::max<std::int64_t>(1, part_voxels / (cell_edge * cell_edge * output.dims[0]));
  const double share = 1 / static_cast<double>(sources.size());
  for (std::size_t s = 0; s < sources.size(); ++s) {
    const ProgressPart of_source = {progress, static_cast<double>(s) * share, share};
    with_pixel_type(sources[s].type, [&]<class T>(T) {
      if (takes_gaussian(plan.options)) {
        const double background = static_cast<double>(rounded_to<T>(options.background));
        const RowGaussianOp op = {
            gaussian_labels(sources[s].grid, number_view(data.view<T>(s).data),
                            options.label_gaussian, background),
            map,
            {output.dims[0], output.dims[1], output.dims[2]},
            number_view(static_cast<T*>(outputs[s]))};
        in_parts(threads, output.dims[1] * output.dims[2], cell_edge * cell_edge * part, of_source,
                 [&](std::int64_t begin, std::int64_t end) {
                   for (std::int64_t row = begin; row < end; ++row) op(row);
                 });
        return;
      }
      RowResampleOp<T> op{};
      op.job.source = data.view<T>(s);
      op.job.filter = options.filter;
      op.job.background = rounded_to<T>(options.background);
      op.job.volume = static_cast<T*>(outputs[s]);
      op.map = map;
      std::copy_n(output.dims.begin(), 3, op.dims);
      in_parts(threads, lines, part, of_source, [&](std::int64_t begin, std::int64_t end) {
        resample_lines(sources[s].type, &op, begin, end);
      });
    });
  }
  if (progress && !progress(1)) throw Cancelled();
}

Volume resample(const Volume& source, const Transform& transform, const ResampleOptions& options) {
  const VolumeView view(source);
  Volume result = make_volume(options.output_grid.value_or(source.grid), source.type,
                              source.components, source.name);
  void* const data = result.data.data();
  resample(std::span(&view, 1), transform, options, std::span(&data, 1));
  return result;
}

}  // namespace tetwarp
