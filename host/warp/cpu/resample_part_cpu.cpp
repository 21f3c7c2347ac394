/// @file resample_part_cpu.cpp
/// Checks the arguments of resample(), and runs its rows on host threads.
#include "host/warp/resample_part.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <tetwarp/error.hpp>

#include "host/base/index_space.hpp"
#include "host/base/parallel.hpp"
#include "host/base/pixel_dispatch.hpp"
#include "host/base/region_grid.hpp"
#include "host/base/warp_backend.hpp"
#include "host/exec/exec_cpu.hpp"
#include "host/warp/box_sums.hpp"
#include "host/warp/cpu/rows/row_resample_cpu.hpp"
#include "host/warp/cpu/transform_links.hpp"
#include "host/warp/sources.hpp"
#include "host/warp/stages/label_stages.hpp"
#include "host/warp/transform_checks.hpp"
#include "kernels/warp/row_resample.hpp"

namespace tetwarp {
namespace {
/// Whether a map moves voxels along an axis of the output along the same axis of another grid, but
/// for rounding.
bool is_parallel(const IndexAffine& map, const Grid& output) {
  constexpr double rounding = 1e-9;  // of an index
  for (int row = 0; row < 3; ++row) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto count = static_cast<double>(output.dims[static_cast<std::size_t>(axis)]);
      if (row != axis && !(std::abs(map.linear[row][axis]) * count < rounding)) return false;
    }
  }
  return true;
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
  IndexAffine to_source = index_map(source);
  if (begins_affine && links.size() == 1) {
    map.to_source = composed(to_source, map.to_first);
    return map;
  }
  const bool is_single = std::ranges::count_if(links, &TransformLink::is_affine) + 1 ==
                         std::ssize(links);  // one field or spline, maybe between affine maps
  if (is_single && links.size() > 1) {
    if (links.back().is_affine()) to_source = composed(to_source, links.back().affine);
    map.to_source = composed(to_source, map.to_first);
  }
  if (is_single) map.to_world = map.to_first;
  for (int row = 0; row < 3; ++row) std::copy_n(to_source.linear[row], 3, map.from_world[row]);
  const Grid& grid = *first_grid(transform);
  const TransformLink& first = links[begins_affine ? 1 : 0];
  const bool is_field = is_single && first.field.vectors != nullptr;
  if (is_field && !begins_affine && grid == output) {
    map.field = first.field;
    return map;
  }
  map.links = {&first, is_single ? 1 : std::ssize(links) - (begins_affine ? 1 : 0)};
  map.to_first_index =
      begins_affine ? composed(index_map(grid), map.to_first) : between_grids(grid, output);
  map.is_parallel = is_field && is_parallel(map.to_first_index, output);
  return map;
}

/// Checks the window of the sources and what is read of it.
void set_window(const Grid& grid, const SourceWindow& window, WarpPlan& plan) {
  plan.source_region = checked_region(grid, window.region);
  if (plan.source_region == Region{{0, 0, 0}, grid.dims}) return;
  if (plan.options.filter == Filter::bspline || takes_gaussian(plan.options)) {
    throw std::invalid_argument("source window: bspline and gaussian need the whole source");
  }
  if (plan.options.overshoot == Overshoot::clamp && window.ranges.size() != plan.sources.size()) {
    throw std::invalid_argument("source window: expected the range of every source");
  }
  plan.options.source_window = window;
}

WarpPlan make_plan(std::span<const VolumeView> sources,
                   const ResampleOptions& options,
                   const ResamplePart& part) {
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
  plan.output_grid = options.output_grid.value_or(grid);
  check_grid(plan.output_grid, "output grid");
  plan.region = checked_region(plan.output_grid, part.output);
  if (plan.region.begin[0] != 0 || plan.region.end[0] != plan.output_grid.dims[0]) {
    throw std::invalid_argument("region: expected whole rows of the output");
  }
  set_window(grid, part.source, plan);
  return plan;
}

constexpr std::int64_t part_voxels = 1 << 22;  // between two reports of progress

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

/// One source of a job.
struct SourceJob {
  const WarpPlan& plan;
  const ResampleOptions& options;
  const ResampleMap& map;
  int threads;
  std::array<std::int64_t, 3> dims;  ///< of the part
};

/// Rows of labels by Gaussian weights.
template <class T>
void run_labels(const SourceJob& job, const T* labels, T* output, const ProgressPart& progress) {
  const double background = static_cast<double>(rounded_to<T>(job.options.background));
  const RowGaussianOp op = {gaussian_labels(job.plan.sources.front().grid, number_view(labels),
                                            job.options.label_gaussian, background),
                            job.map,
                            {job.dims[0], job.dims[1], job.dims[2]},
                            {job.plan.region.begin[1], job.plan.region.begin[2]},
                            number_view(output)};
  const std::int64_t size = std::max<std::int64_t>(1, part_voxels / job.dims[0]);
  in_parts(job.threads, job.dims[1] * job.dims[2], size, progress,
           [&](std::int64_t begin, std::int64_t end) {
             for (std::int64_t row = begin; row < end; ++row) op(row);
           });
}

/// Rows of samples.
template <class T>
void run_samples(const SourceJob& job,
                 const SourceView<T>& source,
                 T* output,
                 const ProgressPart& progress) {
  RowResampleOp<T> op{};
  op.job.source = source;
  op.job.filter = job.options.filter;
  op.job.background = rounded_to<T>(job.options.background);
  op.job.volume = output;
  op.map = job.map;
  // A window is computed as the whole is, of which vectors may not reach all voxels.
  op.may_use_vectors =
      job.plan.sources.front().grid.voxel_count() <= std::numeric_limits<std::int32_t>::max();
  std::copy_n(job.dims.begin(), 3, op.dims);
  std::copy_n(job.plan.region.begin.begin() + 1, 2, op.begin);
  const std::int64_t size =
      std::max<std::int64_t>(1, part_voxels / (cell_edge * cell_edge * job.dims[0]));
  in_parts(job.threads, resample_lines(op.dims), size, progress,
           [&](std::int64_t begin, std::int64_t end) {
             resample_lines(pixel_type_of<T>(), &op, begin, end);
           });
}
}  // namespace

void resample_part(std::span<const VolumeView> sources,
                   const Transform& transform,
                   const ResampleOptions& options,
                   const ResamplePart& part,
                   std::span<void* const> outputs,
                   const Progress& progress) {
  const std::vector<TransformLink> links = folded(links_of(transform, part.fields));
  const WarpPlan plan = make_plan(sources, options, part);
  if (outputs.size() != sources.size() ||
      std::find(outputs.begin(), outputs.end(), nullptr) != outputs.end()) {
    throw std::invalid_argument("outputs: expected one array per source");
  }
  const int threads = thread_count(options.threads);
  CpuExec exec(threads, StageClocks::off);
  WarpSources<CpuExec> data(exec, plan);
  const ResampleMap map =
      make_map(sources.front().grid, plan.output_grid, transform, links, options);
  const SourceJob job{plan, options, map, threads,
                      grid_of_region(plan.output_grid, plan.region).dims};
  const double share = 1 / static_cast<double>(sources.size());
  for (std::size_t s = 0; s < sources.size(); ++s) {
    const ProgressPart of_source = {progress, static_cast<double>(s) * share, share};
    with_pixel_type(sources[s].type, [&]<class T>(T) {
      T* const output = static_cast<T*>(outputs[s]);
      if (takes_gaussian(plan.options)) {
        run_labels(job, data.view<T>(s).data, output, of_source);
      } else {
        run_samples(job, data.view<T>(s), output, of_source);
      }
    });
  }
  if (progress && !progress(1)) throw Cancelled();
}

}  // namespace tetwarp
