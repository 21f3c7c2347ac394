/// @file output_files.cpp
#include "host/cli/output_files.hpp"

#include <tetwarp/version.hpp>

namespace tetwarp::cli {

Fingerprint fingerprint_of_options(const WarpArguments& arguments,
                                   const JobPlan& plan,
                                   const VolumePlan& volume) {
  Fingerprint fingerprint;
  const WarpOptions& warp = arguments.warp;
  fingerprint.add(TETWARP_VERSION);
  fingerprint.add(plan.backend);
  fingerprint.add(warp.filter);
  fingerprint.add(warp.overshoot);
  fingerprint.add(warp.outside);
  fingerprint.add(warp.background);
  fingerprint.add(arguments.extra.mask);
  fingerprint.add(arguments.extra.tet);
  fingerprint.add(volume.output_grid);
  fingerprint.add(volume.written_grid);
  fingerprint.add(plan.mesh.mesh().tets);
  fingerprint.add(plan.mesh.mesh().rest_positions);
  return fingerprint;
}

bool is_up_to_date(const WarpArguments& arguments,
                   const std::string& output,
                   const Fingerprint& fingerprint) {
  return arguments.resume && read_fingerprint(output) == fingerprint.text();
}

VolumeWriteOptions write_options(const WarpArguments& arguments, const Fingerprint& fingerprint) {
  return {.compress = arguments.compress,
          .background = arguments.warp.background,
          .skip_background_chunks = arguments.warp.skip.background_chunks,
          .fingerprint = fingerprint.text()};
}

Counts counts_of(const WrittenFile& file) {
  Counts counts;
  counts.bytes_written = file.bytes;
  counts.chunks_background = file.chunks_background;
  return counts;
}

}  // namespace tetwarp::cli
