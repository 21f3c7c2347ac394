/// @file output_files.hpp
/// Options, fingerprints and counts of output files.
#pragma once
#include <optional>
#include <string>

#include <tetwarp/io.hpp>
#include <tetwarp/report.hpp>

#include "host/cli/job/fingerprint.hpp"
#include "host/cli/job/job_plan.hpp"

namespace tetwarp::cli {

/// Options of the Warper of a volume.
WarpOptions warp_options(const WarpArguments& arguments,
                         const JobPlan& plan,
                         const VolumePlan& volume);

/// Hash of everything that determines an output, except for samples and positions.
Fingerprint fingerprint_of_options(const WarpArguments& arguments,
                                   const JobPlan& plan,
                                   const VolumePlan& volume);

/// Whether --resume keeps files: they are complete and have this fingerprint.
bool is_up_to_date(const WarpArguments& arguments,
                   const std::vector<std::string>& files,
                   const Fingerprint& fingerprint);

VolumeWriteOptions write_options(const WarpArguments& arguments,
                                 const VolumePlan& volume,
                                 const Fingerprint& fingerprint);

/// Facts of an extra output: the codes and the unit of the source's space, else the defaults.
/// Nothing if the source has none.
std::optional<NiftiFacts> facts_of_extra(const std::optional<NiftiFacts>& source, int components);

/// Fills the report of a step that equals the last one: counts that describe the outputs are
/// copied, counts of work stay zero.
void repeat_report(const StepReport& last, StepReport& report);

/// Adds a step that is complete to the report of a job.
void add_step(const StepReport& step, Report& job);

/// What a written file adds to a report.
Counts counts_of(const WrittenFile& file);

}  // namespace tetwarp::cli
