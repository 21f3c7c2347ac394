/// @file disk_plan.cpp
/// Adds the sizes of temporary files, and compares them with the free space.
#include "host/cli/job/disk_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <system_error>
#include <utility>
#include <vector>

#include "host/cli/common/file_checks.hpp"
#include "host/cli/common/ranks.hpp"
#include "host/cli/job/memory_plan.hpp"
#include "io/files/extension.hpp"
#include "io/files/finished_file.hpp"
#include "io/files/memory.hpp"

namespace tetwarp::cli {
namespace {
/// Samples of all steps of the output that are kept for a while.
double output_bytes(const VolumePlan& plan, const WarpArguments& arguments) {
  const auto steps = plan.is_series ? static_cast<double>(plan.steps.size()) : 1;
  return steps * static_cast<double>(plan.written_grid.voxel_count()) *
         voxel_bytes(arrays_written(plan, arguments));
}

/// Whether an output is written to a temporary file, before it is packed or put in order.
bool is_written_twice(const VolumePlan& plan, const WarpArguments& arguments, std::int64_t blocks) {
  const std::string& output = plan.outputs.front();
  if (plan.is_series) return has_nifti_name(output) || has_image_name(output);
  if (has_nifti_name(output)) return blocks > 1;
  const bool is_packed = arguments.compress > 0 && !has_extension(output, ".mgh");
  return has_image_name(output) && (is_packed || has_extension(output, ".mgz"));
}

/// Processes that work on a volume at a time: each takes an output of its own, or reads the blocks
/// of one that the first one writes.
std::int64_t processes_of(const VolumePlan& plan, const WarpArguments& arguments) {
  const std::int64_t launched = launched_count();
  return shares_blocks(plan, arguments, static_cast<int>(launched))
             ? launched
             : std::min(launched, std::ssize(plan.outputs));
}

/// temporary_disk() without steps of a series that can be resumed, whose files may be packed.
double scratch_bytes(const VolumePlan& plan, const WarpArguments& arguments, std::int64_t blocks) {
  constexpr std::int64_t several = 2;  // the blocks of processes that share an output
  const bool shares = shares_blocks(plan, arguments, launched_count());
  if (shares) blocks = std::max(blocks, several);
  const auto readers = static_cast<double>(processes_of(plan, arguments));
  const double writers =
      shares ? std::min(readers, static_cast<double>(plan.outputs.size())) : readers;
  const double written =
      is_written_twice(plan, arguments, blocks) ? writers * output_bytes(plan, arguments) : 0;
  if (blocks == 0) return written;
  double unpacked = 0;
  for (const ArrayHeader& array : plan.arrays) {
    const std::int64_t step = arguments.source_step.value_or(0);
    unpacked += VolumeReader(plan.path, array.name, step, plan.read).unpacked_bytes();
  }
  for (const FieldReader& field : plan.fields) unpacked += field.unpacked_bytes;
  return written + readers * unpacked;
}

/// Refuses a job for whose temporary files, beside the outputs of a plan, there is no room.
void check_room(VolumePlan& plan, const WarpArguments& arguments, double bytes) {
  if (bytes == 0 || !plan.refusal.empty()) return;
  const std::string& output = plan.outputs.front();
  const std::string folder =
      existing_folder(std::filesystem::path(link_target(output)).parent_path().string());
  std::error_code error;
  const auto space = std::filesystem::space(folder, error);
  if (error || bytes <= static_cast<double>(space.available)) return;
  refuse(plan, arguments,
         fmt::format("{}: temporary files beside it take {} of disk, {} are free in folder '{}'; "
                     "free space, or name an output on another disk",
                     output, bytes_text(bytes), bytes_text(static_cast<double>(space.available)),
                     folder));
}
}  // namespace

double temporary_disk(const VolumePlan& plan, const WarpArguments& arguments, std::int64_t blocks) {
  return scratch_bytes(plan, arguments, blocks) +
         (may_resume_within(plan, arguments) && !shares_blocks(plan, arguments, launched_count())
              ? output_bytes(plan, arguments)
              : 0);
}

void check_room(std::span<VolumePlan> plans, const WarpArguments& arguments) {
  struct Share {
    double bytes;  // of a process
    std::int64_t processes;
    VolumePlan* plan;
  };
  // How many blocks there are is planned later, from the positions.
  std::vector<Share> all;
  for (VolumePlan& plan : plans) {
    const std::int64_t processes = processes_of(plan, arguments);
    const double bytes = scratch_bytes(plan, arguments, plan.memory_limit > 0 ? 2 : 0);
    all.push_back({bytes / static_cast<double>(processes), processes, &plan});
  }
  // The processes are at the largest volumes at a time.
  std::ranges::stable_sort(all, std::ranges::greater{}, &Share::bytes);
  double bytes = 0;
  std::int64_t left = launched_count();
  for (const Share& share : all) {
    const std::int64_t taken = std::min(left, share.processes);
    bytes += static_cast<double>(taken) * share.bytes;
    left -= taken;
  }
  check_room(*all.front().plan, arguments, bytes);
}

}  // namespace tetwarp::cli
