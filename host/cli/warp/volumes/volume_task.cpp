/// @file volume_task.cpp
/// What follows from the plan of a volume.
#include "host/cli/warp/volumes/volume_task.hpp"

#include "host/cli/job/memory_plan.hpp"
#include "host/cli/job/output_files.hpp"

namespace tetwarp::cli {

VolumeTask::VolumeTask(const WarpArguments& arguments,
                       const JobPlan& job,
                       const VolumePlan& volume,
                       int rank_count)
    : arguments(arguments),
      job(job),
      volume(volume),
      is_whole(volume.memory_limit == 0 && rank_count == 1),
      writes_beside(!is_whole || volume.writes_beside),
      region(arguments.warp.region.value_or(Region{{0, 0, 0}, volume.output_grid.dims})),
      options(warp_options(arguments, job, volume)),
      outputs(arrays_written(volume, arguments)) {
  if (!is_whole) options.expert.skip.unchanged_tets = false;  // a block is not computed twice
}

}  // namespace tetwarp::cli
