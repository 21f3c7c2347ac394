/// @file batch_order.cpp
/// Compares the files of jobs.
#include "host/cli/warp/batch_order.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <utility>

#include "host/cli/common/file_checks.hpp"
#include "host/cli/common/interrupt.hpp"
#include "host/cli/job/job_plan.hpp"
#include "host/cli/job/output_writer.hpp"
#include "host/cli/job/provenance.hpp"
#include "host/cli/warp/transform_job.hpp"
#include "io/files/numbered_files.hpp"

namespace tetwarp::cli {
namespace {
/// A path as given, since it may be missing, and the files that it stands for.
void add_read(const std::string& path, std::set<std::string>& reads) {
  reads.insert(canonical_path(path));
  try {
    for (const std::string& file : files_of(path)) reads.insert(canonical_path(file));
  } catch (const std::exception&) {
    // The job reports what is wrong with its file.
  }
}

JobFiles files_of_job(const BatchJob& job) {
  JobFiles files;
  std::vector<std::string> writes;
  if (!job.error.empty()) {
    if (!job.output.empty()) files.writes = {canonical_path(job.output)};
    files.is_planned = true;
    return files;
  }
  const WarpArguments& arguments = job.arguments;
  for (const std::string& input : arguments.inputs()) add_read(input, files.reads);
  const bool is_folder = arguments.volumes().size() > 1;
  files.stem = is_folder ? canonical_path(arguments.output) + "/"
                         : canonical_path(split_name(arguments.output).stem);
  try {
    writes =
        names_transform(arguments) ? transform_job_files(arguments) : plan_job(arguments).outputs();
    files.is_planned = true;
  } catch (const Cancelled&) {
    throw;
  } catch (const std::exception&) {
    writes = {arguments.output};
  }
  for (const std::string& file : files_to_write(arguments, writes)) {
    files.writes.insert(canonical_path(file));
  }
  return files;
}

bool may_write(const JobFiles& job, const std::string& file) {
  return job.writes.contains(file) || (!job.is_planned && file.starts_with(job.stem));
}

/// One of these files that a job may write; null: none.
const std::string* written_of(const std::set<std::string>& files, const JobFiles& job) {
  const auto found =
      std::ranges::find_if(files, [&](const std::string& file) { return may_write(job, file); });
  return found == files.end() ? nullptr : &*found;
}
}  // namespace

std::vector<JobFiles> files_of_jobs(const std::vector<BatchJob>& jobs) {
  std::vector<JobFiles> all;
  for (const BatchJob& job : jobs) {
    stop_if_interrupted();
    all.push_back(files_of_job(job));
  }
  const std::vector<std::vector<Wait>> waits = waits_of_jobs(all);
  for (std::size_t j = 0; j < all.size(); ++j) {
    const auto is_made = [](const Wait& wait) { return !wait.input.empty(); };
    all[j].is_planned = all[j].is_planned && std::ranges::none_of(waits[j], is_made);
  }
  return all;
}

void check_collisions(const std::vector<BatchJob>& jobs,
                      const std::vector<JobFiles>& files,
                      const WarpArguments& shared) {
  std::map<std::string, std::string> writers;
  const auto claim = [&](const std::string& file, const std::string& writer) {
    const auto [first, is_new] = writers.emplace(file, writer);
    if (!is_new && first->second != writer) {
      throw IoError(file, "",
                    fmt::format("{} and {} both write it; nothing was started, give one of them "
                                "another name",
                                first->second, writer));
    }
  };
  if (!shared.report.empty()) {
    check_output_file(shared.report, {shared.batch});
    claim(canonical_path(shared.report), "the report");
  }
  for (std::size_t j = 0; j < jobs.size(); ++j) {
    if (!jobs[j].error.empty()) continue;
    for (const std::string& file : files[j].writes) claim(file, fmt::format("job {}", j + 1));
  }
}

std::vector<std::vector<Wait>> waits_of_jobs(const std::vector<JobFiles>& files) {
  std::map<std::string, std::vector<std::size_t>> readers, writers;  // so far
  std::vector<std::size_t> unplanned;                                // so far
  std::vector<std::vector<Wait>> all(files.size());
  for (std::size_t j = 0; j < files.size(); ++j) {
    const JobFiles& job = files[j];
    std::map<std::size_t, std::string> found;  // inputs by earlier job
    const auto add = [&](const std::map<std::string, std::vector<std::size_t>>& jobs,
                         const std::string& file, const std::string& input) {
      const auto at = jobs.find(file);
      if (at == jobs.end()) return;
      for (const std::size_t i : at->second) found[i] = input.empty() ? found[i] : input;
    };
    for (const std::string& file : job.writes) {
      add(readers, file, "");
      add(writers, file, "");
    }
    for (const std::string& file : job.reads) add(writers, file, file);
    for (const std::size_t i : unplanned) {
      if (written_of(job.writes, files[i]) != nullptr) found[i];
      const std::string* const input = written_of(job.reads, files[i]);
      if (input != nullptr) found[i] = *input;
    }
    for (std::size_t i = 0; i < j && !job.is_planned; ++i) {
      if (written_of(files[i].reads, job) != nullptr || written_of(files[i].writes, job) != nullptr)
        found[i];
    }
    for (auto& [i, input] : found) all[j].push_back({i, std::move(input)});
    for (const std::string& file : job.reads) readers[file].push_back(j);
    for (const std::string& file : job.writes) writers[file].push_back(j);
    if (!job.is_planned) unplanned.push_back(j);
  }
  return all;
}

}  // namespace tetwarp::cli
