/// @file disk_plan.cpp
/// Adds the sizes of temporary files, and compares them with the free space.
#include "host/cli/job/disk_plan.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "host/cli/common/file_checks.hpp"
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

/// temporary_disk() without steps of a series that can be resumed, whose files may be packed.
double scratch_bytes(const VolumePlan& plan, const WarpArguments& arguments, std::int64_t blocks) {
  double bytes = is_written_twice(plan, arguments, blocks) ? output_bytes(plan, arguments) : 0;
  if (blocks == 0) return bytes;
  for (const ArrayHeader& array : plan.arrays) {
    const std::int64_t step = arguments.source_step.value_or(0);
    bytes += VolumeReader(plan.path, array.name, step, plan.read).unpacked_bytes();
  }
  for (const FieldReader& field : plan.fields) bytes += field.unpacked_bytes;
  return bytes;
}
}  // namespace

double temporary_disk(const VolumePlan& plan, const WarpArguments& arguments, std::int64_t blocks) {
  return scratch_bytes(plan, arguments, blocks) +
         (may_resume_within(plan, arguments) ? output_bytes(plan, arguments) : 0);
}

void check_room(VolumePlan& plan, const WarpArguments& arguments) {
  // How many blocks there are is planned later, from the positions.
  const double bytes = scratch_bytes(plan, arguments, plan.memory_limit > 0 ? 2 : 0);
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

}  // namespace tetwarp::cli
