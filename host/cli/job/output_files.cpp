/// @file output_files.cpp
/// Options, fingerprints and counts of output files.
#include "host/cli/job/output_files.hpp"

#include <algorithm>
#include <tetwarp/version.hpp>

namespace tetwarp::cli {

WarpOptions warp_options(const WarpArguments& arguments,
                         const JobPlan& plan,
                         const VolumePlan& volume) {
  WarpOptions options = arguments.warp;
  options.backend = plan.backend;
  options.stage_times = !arguments.report.empty();
  options.output_grid = volume.output_grid;
  for (const ArrayHeader& array : volume.arrays) {
    options.quantities.push_back(arguments.quantity_of(array.name));
  }
  return options;
}

Fingerprint fingerprint_of_options(const WarpArguments& arguments,
                                   const JobPlan& plan,
                                   const VolumePlan& volume) {
  Fingerprint fingerprint;
  fingerprint.add(TETWARP_VERSION);
  fingerprint.add(warp_options(arguments, plan, volume));
  for (const std::size_t e : arguments.extra) fingerprint.add(e);
  for (const ArrayHeader& array : volume.arrays) {
    if (array.nifti) fingerprint.add(*array.nifti);
  }
  fingerprint.add(volume.written_grid);
  fingerprint.add(volume.active);
  fingerprint.add(plan.mesh.mesh().tets);
  fingerprint.add(plan.mesh.mid_nodes());
  fingerprint.add(plan.mesh.mesh().hexes);
  fingerprint.add(plan.mesh.mesh().rest_positions);
  return fingerprint;
}

bool is_up_to_date(const WarpArguments& arguments,
                   const std::vector<std::string>& files,
                   const Fingerprint& fingerprint) {
  const std::string expected = fingerprint.text();
  return arguments.resume && std::ranges::all_of(files, [&](const std::string& file) {
           return read_fingerprint(file) == expected;
         });
}

VolumeWriteOptions write_options(const WarpArguments& arguments,
                                 const VolumePlan& volume,
                                 const Fingerprint& fingerprint) {
  return {.compress = arguments.compress,
          .background = arguments.warp.background,
          .skip_background_chunks = arguments.warp.expert.skip.background_chunks,
          .fingerprint = fingerprint.text(),
          .scalars = volume.active};
}

std::optional<NiftiFacts> facts_of_extra(const std::optional<NiftiFacts>& source, int components) {
  if (!source) return std::nullopt;
  NiftiFacts facts = default_nifti_facts(components);
  facts.sform_code = source->sform_code;
  facts.qform_code = source->qform_code;
  facts.xyzt_units = source->xyzt_units;
  return facts;
}

void repeat_report(const StepReport& last, StepReport& report) {
  for (const auto count :
       {&Counts::voxels, &Counts::covered, &Counts::outside, &Counts::tetrahedra, &Counts::inverted,
        &Counts::flat, &Counts::folded, &Counts::cells, &Counts::tets_averaged,
        &Counts::values_clipped, &Counts::voxels_straightened}) {
    report.counts.*count = last.counts.*count;
  }
  report.counts.steps_unchanged = 1;
  report.totals = last.totals;
}

void add_step(const StepReport& step, Report& job) {
  job.timings += step.timings;
  job.counts += step.counts;
  job.steps.push_back(step);
  job.steps.back().timings.total += step.timings.read + step.timings.write;
}

Counts counts_of(const WrittenFile& file) {
  Counts counts;
  counts.bytes_written = file.bytes;
  counts.chunks_background = file.chunks_background;
  return counts;
}

}  // namespace tetwarp::cli
