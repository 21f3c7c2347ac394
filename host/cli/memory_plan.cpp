#include "host/cli/memory_plan.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "io/memory.hpp"

namespace tetwarp::cli {
namespace {
/// Throws IoError unless the output can be computed in blocks.
void check_blocks(const VolumePlan& plan, const WarpArguments& arguments) {
  const std::string reason = needs_all_at_once(arguments);
  if (reason.empty()) return;
  throw IoError(plan.path, "",
                fmt::format("{}: source and output need {}, allow more --memory", reason,
                            bytes_text(plan.memory)));
}

/// Bytes per sample that a filter keeps in addition, at its peak.
double filter_bytes(Filter filter, PixelType type) {
  if (filter != Filter::bspline) return 0;
  return size_of(type) <= 2 || type == PixelType::float32 ? 12 : 8;
}
}  // namespace

std::string needs_all_at_once(const WarpArguments& arguments) {
  if (arguments.extra.contains(forward_output)) {
    return "the forward displacement needs the whole mesh; leave out --outputs forward";
  }
  if (arguments.warp.intensity == Intensity::conservative) {
    return "conservative needs the whole source; use --intensity density";
  }
  if (arguments.warp.filter == Filter::bspline) {
    return "bspline needs the whole source; use --filter cubic";
  }
  return {};
}

bool plan_memory(VolumePlan& plan, const WarpArguments& arguments) {
  const auto source_voxels = static_cast<double>(plan.source_grid.voxel_count());
  const auto output_voxels = static_cast<double>(plan.written_grid.voxel_count());
  double source_bytes = 0, output_bytes = 0;
  for (const std::size_t e : arguments.extra) {
    output_bytes += output_voxels * extra_outputs[e].components *
                    static_cast<double>(size_of(extra_outputs[e].type));
  }
  for (const ArrayHeader& array : plan.arrays) {
    const double voxel_bytes = array.components * static_cast<double>(size_of(array.type));
    source_bytes +=
        source_voxels *
        (voxel_bytes + array.components * filter_bytes(arguments.warp.filter, array.type));
    output_bytes += output_voxels * voxel_bytes;
  }
  const double bytes = source_bytes + output_bytes;
  plan.memory = bytes;
  if (arguments.memory > 0) {
    // 1 % is for lists of cells and tetrahedra; the memory of the process is in use already.
    const double limit = arguments.memory - 1.1 * resident_memory() - 0.01 * bytes;
    if (bytes > limit) {
      plan.memory_limit = arguments.memory;
      check_blocks(plan, arguments);
    }
    return bytes + output_bytes <= limit;
  }
  const double available = available_memory();
  if (bytes > available && !arguments.dry_run) {
    throw std::invalid_argument(fmt::format(
        "{}: {} x {} x {} output voxels need {} of memory with the source, {} are available; use "
        "--memory to stream them, a smaller --roi, coarser --dims and --spacing, or fewer arrays",
        plan.path, plan.written_grid.dims[0], plan.written_grid.dims[1], plan.written_grid.dims[2],
        bytes_text(bytes), bytes_text(available)));
  }
  return bytes + output_bytes <= available;
}

}  // namespace tetwarp::cli
