/// @file memory_plan.cpp
/// Estimates of memory and disk, and whether a volume is computed in blocks.
#include "host/cli/job/memory_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <thread>

#include "host/cli/job/output_files.hpp"
#include "host/warp/box_sums.hpp"
#include "io/files/memory.hpp"
#include "kernels/base/hex_view.hpp"

namespace tetwarp::cli {
namespace {
/// Bytes per sample that a filter keeps in addition, at its peak.
double filter_bytes(Filter filter, PixelType type) {
  if (filter != Filter::bspline) return 0;
  return size_of(type) <= 2 || type == PixelType::float32 ? 12 : 8;
}

/// Lists of cells and tetrahedra of a whole output, at their largest over all steps.
double list_memory(const VolumePlan& plan,
                   const WarpArguments& arguments,
                   const MeshReader& mesh,
                   const std::vector<std::int64_t>& steps) {
  WarpOptions options = arguments.warp;
  options.output_grid = plan.output_grid;
  BlockPlanner planner(plan.source_grid, mesh.mesh(), options);
  BlockLimits without_samples;
  without_samples.source_voxel = without_samples.output_voxel = 0;
  double bytes = 0;
  for (const std::int64_t step : steps) {
    const BlockPlan whole = planner.plan(mesh.read_step(step), without_samples);
    bytes = std::max(bytes, whole.blocks.front().host_bytes);
  }
  return bytes;
}
}  // namespace

double voxel_bytes(const std::vector<ArrayHeader>& arrays) {
  double bytes = 0;
  for (const ArrayHeader& array : arrays) {
    bytes += array.components * static_cast<double>(size_of(array.type));
  }
  return bytes;
}

std::vector<ArrayHeader> arrays_written(const VolumePlan& plan, const WarpArguments& arguments) {
  std::vector<ArrayHeader> arrays = plan.arrays;
  for (const std::size_t e : arguments.extra) {
    const ExtraOutput& extra = extra_outputs[e];
    arrays.push_back({extra.array(), extra.type, extra.components,
                      facts_of_extra(plan.arrays.front().nifti, extra.components)});
  }
  return arrays;
}

double fixed_memory(const VolumePlan& plan,
                    const WarpArguments& arguments,
                    const MeshHeader& mesh) {
  constexpr double mebibyte = 1 << 20;
  // Pages of code that a run loads later, the heap, HDF5's lists of freed buffers and its index.
  constexpr double growth = 10 * mebibyte;
  constexpr double thread_bytes = mebibyte / 4;  // stack and heap in use
  // HDF5's cache of chunks per array, and a buffer for converted numbers or for deflate.
  constexpr double cache = mebibyte, buffer = mebibyte;
  // With a stored chunk, and its buffer before and after it grows during inflation.
  const auto reader_bytes = [](double chunk) { return cache + buffer + 1.5 * chunk; };
  const auto threads = arguments.warp.threads > 0
                           ? static_cast<double>(arguments.warp.threads)
                           : static_cast<double>(std::thread::hardware_concurrency());
  const auto tets = static_cast<double>(mesh.tet_count + tets_per_hex * mesh.hex_count);
  // Footprints, lists of tetrahedra, and positions in several forms.
  double bytes = resident_memory() + growth + thread_bytes * threads + 160 * tets +
                 120 * static_cast<double>(mesh.node_count);
  // Parts of facets of two cells per thread; faces while neighbors are found.
  if (arguments.warp.intensity == Intensity::conservative) {
    bytes += 4 * mebibyte * threads + 110 * tets;
  }
  for (const ArrayHeader& array : plan.arrays) {
    const VolumeReader reader(plan.path, array.name, arguments.source_step.value_or(0), plan.read);
    bytes += reader_bytes(reader.chunk_bytes());
  }
  for (const FieldReader& field : plan.fields) {
    if (field.read) bytes += reader_bytes(field.chunk_bytes);
  }
  const auto outputs = static_cast<double>(arrays_written(plan, arguments).size());
  return bytes + outputs * cache + (arguments.compress > 0 ? buffer : 0);
}

double curve_memory(const MeshReader& mesh) {
  if (mesh.mid_nodes().empty()) return 0;
  // Nodes on edges three times, and a copy of the mesh while the run begins.
  const MeshHeader& size = mesh.header();
  return 90 * static_cast<double>(size.tet_count) + 24 * static_cast<double>(size.node_count);
}

double owner_bytes(const WarpArguments& arguments, const MeshReader& mesh) {
  const bool needs_owners = extends(arguments.warp.outside) || takes_gaussian(arguments.warp) ||
                            !mesh.mid_nodes().empty();
  return needs_owners && !arguments.extra.contains(owner_output) ? sizeof(std::int32_t) : 0;
}

std::string limit_text(double bytes) {
  // One more, because the memory of the process differs a little between runs.
  return fmt::format("{:.0f}M", std::ceil(bytes / (1 << 20)) + 1);
}

double least_block_memory(BlockPlanner& planner,
                          const std::vector<Point3>& positions,
                          BlockLimits limits) {
  limits.host = limits.device = std::numeric_limits<double>::infinity();
  limits.max_voxels = 1;
  double least = 0;
  for (const WarpBlock& block : planner.plan(positions, limits).blocks) {
    least = std::max(least, block.host_bytes);
  }
  return least;
}

std::string needs_all_at_once(const WarpArguments& arguments) {
  if (arguments.extra.contains(forward_output)) {
    return "the forward displacement needs the whole mesh; leave out --outputs forward";
  }
  if (arguments.warp.intensity == Intensity::conservative) {
    return "conservative needs the whole source; use --intensity density";
  }
  if (arguments.warp.label_rule != LabelRule::linear) {
    return fmt::format("--label-rule {} needs the whole source; use linear",
                       name_of(arguments.warp.label_rule));
  }
  if (arguments.warp.filter == Filter::bspline) {
    return "bspline needs the whole source; use --filter cubic";
  }
  if (extends(arguments.warp.outside)) {
    return fmt::format("--outside {} needs the whole mesh; use identity",
                       name_of(arguments.warp.outside));
  }
  return {};
}

bool shares_blocks(const VolumePlan& plan, const WarpArguments& arguments, int processes) {
  return processes > 1 && arguments.volumes().size() == 1 && plan.outputs.size() == 1 &&
         needs_all_at_once(arguments).empty();
}

void refuse(VolumePlan& plan, const WarpArguments& arguments, const std::string& reason) {
  if (!arguments.dry_run) throw std::invalid_argument(reason);
  plan.refusal = reason;
}

double set_memory_limit(VolumePlan& plan, const WarpArguments& arguments) {
  const double available = resident_memory() + available_memory();
  const double limit = arguments.memory > 0 ? std::min(arguments.memory, available) : available;
  if (plan.memory <= limit) return limit;
  if (arguments.memory == 0) {
    const auto& dims = plan.written_grid.dims;
    refuse(plan, arguments,
           fmt::format("{}: {} x {} x {} output voxels need {} of memory with the source{}, {} are "
                       "available; use --memory to stream them, {}coarser --dims and --spacing, or "
                       "fewer arrays",
                       plan.path, dims[0], dims[1], dims[2], bytes_text(plan.memory),
                       plan.fields.empty() ? "" : " and the transform", bytes_text(limit),
                       plan.fields.empty() ? "a smaller --roi, " : ""));
    return limit;
  }
  const std::string reason = needs_all_at_once(arguments);
  if (!reason.empty()) {
    throw IoError(plan.path, "",
                  fmt::format("{}, or give --memory at least {}", reason, limit_text(plan.memory)));
  }
  plan.memory_limit = limit;
  return limit;
}

bool plan_memory(VolumePlan& plan,
                 const WarpArguments& arguments,
                 const MeshReader& mesh,
                 const std::vector<std::int64_t>& steps) {
  const auto source_voxels = static_cast<double>(plan.source_grid.voxel_count());
  const auto output_voxels = static_cast<double>(plan.written_grid.voxel_count());
  const double output_bytes = output_voxels * voxel_bytes(arrays_written(plan, arguments));
  double source_bytes = source_voxels * voxel_bytes(plan.arrays);
  for (const ArrayHeader& array : plan.arrays) {
    source_bytes +=
        source_voxels * array.components * filter_bytes(arguments.warp.filter, array.type);
  }
  const double samples = source_bytes + output_bytes + owner_bytes(arguments, mesh) * output_voxels;
  plan.memory = samples + fixed_memory(plan, arguments, mesh.header()) + curve_memory(mesh);
  const bool is_exact = arguments.memory > 0 || arguments.dry_run;
  plan.memory += is_exact ? list_memory(plan, arguments, mesh, steps) : 0.01 * samples;
  return plan.memory + output_bytes <= set_memory_limit(plan, arguments);
}

}  // namespace tetwarp::cli
