/// @file batch_file.hpp
/// The file of `tetwarp warp --batch`: {"jobs": [{"volume": ..., "mesh": ..., "output": ..., any
/// long option without its dashes}, ...]}, or the same as CSV; see read_job_list().
#pragma once
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/cli/job/warp_arguments.hpp"

namespace tetwarp::cli {

/// One job of a batch file: its arguments, or an error.
struct BatchJob {
  nlohmann::ordered_json keys;        ///< as in the file
  std::vector<std::string> volumes;   ///< relative to the batch file; also of a job with an error
  std::string mesh;                   ///< empty: the job names none
  std::string output;                 ///< empty: the job names none
  std::vector<std::string> words;     ///< its command line
  std::vector<std::string> left_out;  ///< defaults that it does not take: "--steps=3"
  WarpArguments arguments;
  std::string error;  ///< empty: the arguments are valid
};

/// Reads a batch file. Relative paths in it start at its folder.
/// @param defaults  options as given on the command line, for jobs that do not set them and do not
///                  refuse them
/// @throws IoError  when the file holds no list of jobs, or no job takes a default; an error inside
///                  a job is stored in that job
std::vector<BatchJob> read_batch(const std::string& path, const CLI::App& defaults);

/// Makes words and arguments of the keys of a job again, by its files as they are now: they tell
/// its kind and the defaults that it takes.
/// @param path      of the batch file
/// @param defaults  as of read_batch()
void read_again(const std::string& path, const CLI::App& defaults, BatchJob& job);

}  // namespace tetwarp::cli
