/// @file provenance.hpp
/// Files beside outputs that tell what they were made from.
#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "host/cli/job/job_result.hpp"
#include "host/cli/job/warp_arguments.hpp"

namespace tetwarp::cli {

/// What the files OUT.json beside the outputs of a job say of it.
enum class ProvenanceState {
  agrees,      ///< all outputs are as they were written, from these inputs with these options
  missing,     ///< an output has none, and none contradicts
  contradicts  ///< an output, an input, an option or the version is another one
};

/// The files that a job writes: its outputs, with --provenance the files beside them, and the
/// report.
std::vector<std::string> files_to_write(const WarpArguments& arguments,
                                        const std::vector<std::string>& outputs);

/// All files that a job reads, as they are before it runs.
struct InputFacts {
  std::string json;  ///< size and SHA-256 of each; empty: without --provenance
  std::vector<std::pair<std::string, std::filesystem::file_time_type>> times;  ///< last writes
};

/// Reads all inputs of a job with --provenance; nothing of other jobs, and of those that only plan.
/// @throws IoError
InputFacts input_facts(const WarpArguments& arguments);

/// Compares sizes, SHA-256, options and the version. Options that change no value (threads, memory,
/// reports) may differ, and inputs may have moved.
/// @param outputs  of all steps and volumes of the job
ProvenanceState provenance_state(const WarpArguments& arguments,
                                 const InputFacts& inputs,
                                 const std::vector<std::string>& outputs);

/// Writes OUT.json for each file OUT of a job that lacks one or has an older one: the version, the
/// back end, the options as given, and all inputs with their size and SHA-256, as JSON.
/// @param inputs  as they were before the job ran; nothing is written where there are none
/// @param files   that the job writes
/// @throws IoError  also when an input was written while the job ran
void write_provenance(const WarpArguments& arguments,
                      const InputFacts& inputs,
                      const std::vector<std::string>& files,
                      const JobResult& result);

}  // namespace tetwarp::cli
