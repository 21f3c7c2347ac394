/// @file output_files.hpp
/// What makes an output file the one that is wanted: shared by the runs that write some.
#pragma once
#include <string>

#include <tetwarp/io.hpp>
#include <tetwarp/report.hpp>

#include "host/cli/fingerprint.hpp"
#include "host/cli/job_plan.hpp"

namespace tetwarp::cli {

/// For the Warper of a volume's arrays.
WarpOptions warp_options(const WarpArguments& arguments,
                         const JobPlan& plan,
                         const VolumePlan& volume);

/// Of everything that determines an output but the samples and the positions.
Fingerprint fingerprint_of_options(const WarpArguments& arguments,
                                   const JobPlan& plan,
                                   const VolumePlan& volume);

/// Whether --resume may keep a file.
bool is_up_to_date(const WarpArguments& arguments,
                   const std::string& output,
                   const Fingerprint& fingerprint);

VolumeWriteOptions write_options(const WarpArguments& arguments, const Fingerprint& fingerprint);

/// The report of a step that equals the last one: what describes its outputs stays, no work was
/// done.
void repeat_report(const StepReport& last, StepReport& report);

/// What a written file adds to a report.
Counts counts_of(const WrittenFile& file);

}  // namespace tetwarp::cli
