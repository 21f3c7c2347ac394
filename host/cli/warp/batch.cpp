/// @file batch.cpp
/// Runs the jobs of a batch, one after the other or as processes beside each other, and reports
/// each.
#include "host/cli/warp/batch.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <tetwarp/error.hpp>
#include <tetwarp/version.hpp>
#include <thread>
#include <utility>

#include "host/base/parallel.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/common/interrupt.hpp"
#include "host/cli/common/json_text.hpp"
#include "host/cli/job/job_plan.hpp"
#include "host/cli/job/provenance.hpp"
#include "host/cli/warp/batch_file.hpp"
#include "host/cli/warp/job_process.hpp"
#include "host/cli/warp/transform_job.hpp"
#include "host/cli/warp/warp_job.hpp"
#include "io/files/finished_file.hpp"
#include "io/files/memory.hpp"

namespace tetwarp::cli {
namespace {
using Json = nlohmann::ordered_json;

struct Outcome {
  int done = 0;
  int failed = 0;
  int skipped = 0;
  Json reports = Json::array();
};

/// @param is_ended  false: jobs are left to run
void write_report(const std::string& path, const Outcome& outcome, bool is_ended) {
  if (path.empty()) return;
  const char* const ended = outcome.failed > 0 ? "failed" : "done";
  const Json report{{"version", TETWARP_VERSION},      {"status", is_ended ? ended : "interrupted"},
                    {"jobs_done", outcome.done},       {"jobs_failed", outcome.failed},
                    {"jobs_skipped", outcome.skipped}, {"jobs", outcome.reports}};
  write_finished_file(path, json_text(report, 2) + "\n");
}

/// The files that a job will write, reports included. Where planning fails, e.g. because an earlier
/// job makes the input, the output that the job names.
std::vector<std::string> files_written(const BatchJob& job) {
  if (!job.error.empty()) return {};
  std::vector<std::string> files;
  try {
    files = names_transform(job.arguments) ? transform_job_files(job.arguments)
                                           : plan_job(job.arguments).outputs();
  } catch (const std::exception&) {
    files = {job.arguments.output};
  }
  return files_to_write(job.arguments, files);
}

/// Throws IoError when two jobs, or a job and the batch report, write the same file.
void check_collisions(const std::vector<BatchJob>& jobs, const WarpArguments& shared) {
  std::map<std::string, std::string> writers;
  const auto claim = [&](const std::string& file, const std::string& writer) {
    const auto [first, is_new] = writers.emplace(canonical_path(file), writer);
    if (!is_new && first->second != writer) {
      throw IoError(file, "",
                    fmt::format("{} and {} both write it; nothing was started, give one of them "
                                "another name",
                                first->second, writer));
    }
  };
  if (!shared.report.empty()) {
    check_output_file(shared.report, {shared.batch});
    claim(shared.report, "the report");
  }
  for (std::size_t j = 0; j < jobs.size(); ++j) {
    stop_if_interrupted();
    for (const std::string& file : files_written(jobs[j]))
      claim(file, fmt::format("job {}", j + 1));
  }
}

void fail(Outcome& outcome, const std::string& name, Json report, const std::string& reason) {
  fmt::print(stderr, "tetwarp: {}: {}\n", name, reason);
  ++outcome.failed;
  report["status"] = "failed";
  report["error"] = reason;
  outcome.reports.push_back(report);
}

std::string name_of_job(int number) {
  return fmt::format("job {}", number);
}

/// The report of a job that has not run.
Json files_of_job(const BatchJob& job, int number) {
  Json files{{"job", number}, {"volumes", job.volumes}, {"mesh", job.mesh}, {"output", job.output}};
  if (!job.left_out.empty()) files["defaults_left_out"] = job.left_out;
  return files;
}

JobResult run_by_kind(const WarpArguments& arguments, const JobContext& context) {
  return names_transform(arguments) ? run_transform_job(arguments, context)
                                    : run_warp_job(arguments, context);
}

void run_job(const BatchJob& job, int number, bool quiet, Outcome& outcome) {
  const std::string name = name_of_job(number);
  Json report = files_of_job(job, number);
  if (!job.error.empty()) {
    fail(outcome, name, report, job.error);
    return;
  }
  try {
    const JobResult result = run_by_kind(job.arguments, {.label = name, .shows_progress = !quiet});
    report.update(Json::parse(report_json(result)));
    if (!result.refusal.empty()) {
      if (!quiet) fmt::print("{}: {}", name, summary(result));
      fail(outcome, name, report, result.refusal);
      return;
    }
    ++(result.written == 0 && result.plans.empty() ? outcome.skipped : outcome.done);
    outcome.reports.push_back(report);
    if (!quiet) {
      fmt::print(stderr, "{}", storing_note(result.report));
      fmt::print("{}: {}", name, summary(result));
    }
  } catch (const Cancelled&) {
    report["status"] = "interrupted";
    outcome.reports.push_back(report);
  } catch (const std::bad_alloc&) {
    fail(outcome, name, report, "out of memory");
  } catch (const std::exception& error) {
    fail(outcome, name, report, one_line(error.what()));
  }
}

/// Memory that a job will take [byte]; -1 where it cannot be planned, e.g. because an earlier job
/// makes its input.
double planned_memory(const BatchJob& job) {
  WarpArguments arguments = job.arguments;
  arguments.dry_run = true;
  arguments.report.clear();
  double most = 0;
  try {
    const JobResult result = run_by_kind(arguments, {.shows_progress = false});
    for (const StepPlan& plan : result.plans) most = std::max(most, plan.memory);
  } catch (const Cancelled&) {
    throw;
  } catch (const std::exception&) {
    return -1;
  }
  return most;
}

/// Jobs as processes, at most some of them at a time, as far as their memory fits.
class SideBySide {
 public:
  SideBySide(const std::vector<BatchJob>& jobs, const WarpArguments& shared, Outcome& outcome)
      : jobs_(jobs),
        shared_(shared),
        outcome_(outcome),
        folder_(std::filesystem::temp_directory_path() /
                fmt::format("tetwarp-batch-{}", getpid())) {
    std::filesystem::create_directories(folder_);
  }
  SideBySide(const SideBySide&) = delete;
  SideBySide& operator=(const SideBySide&) = delete;
  ~SideBySide() {
    running_.clear();  // ends processes before their files go
    std::error_code error;
    std::filesystem::remove_all(folder_, error);
  }

  void run() {
    plan();
    while (!is_interrupted() && (!waiting_.empty() || !running_.empty())) {
      start_some();
      if (!take_ended()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    for (Running& job : running_) {
      job.process->interrupt();
      while (!job.process->has_ended()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
      Json report = files_of_job(jobs_[job.index], number_of(job.index));
      report["status"] = "interrupted";
      outcome_.reports.push_back(report);
    }
  }

 private:
  struct Waiting {
    std::size_t index;
    double memory;  ///< -1: not known
  };
  struct Running {
    std::size_t index;
    double memory;
    std::unique_ptr<JobProcess> process;
  };

  static int number_of(std::size_t index) { return static_cast<int>(index) + 1; }

  /// Plans the memory of all jobs and states it. Jobs that cannot be planned come last, alone.
  void plan() {
    std::vector<Waiting> unknown;
    std::vector<double> sizes;
    for (std::size_t j = 0; j < jobs_.size(); ++j) {
      stop_if_interrupted();
      if (!jobs_[j].error.empty()) {
        fail(outcome_, name_of_job(number_of(j)), files_of_job(jobs_[j], number_of(j)),
             jobs_[j].error);
        continue;
      }
      const double memory = planned_memory(jobs_[j]);
      (memory < 0 ? unknown : waiting_).push_back({j, memory});
      sizes.push_back(std::max(memory, 0.0));
    }
    waiting_.insert(waiting_.end(), unknown.begin(), unknown.end());
    std::ranges::sort(sizes, std::greater());
    double together = 0;
    const auto beside = std::min(sizes.size(), static_cast<std::size_t>(shared_.jobs));
    for (std::size_t n = 0; n < beside; ++n) together += sizes[n];
    available_ = available_memory();
    if (shared_.quiet) return;
    fmt::print(stderr,
               "tetwarp: {} jobs, up to {} at a time, take up to {} of memory; {} are "
               "available{}\n",
               jobs_.size(), shared_.jobs, bytes_text(together), bytes_text(available_),
               together > available_ ? ", fewer will run at a time" : "");
  }

  void start_some() {
    while (!waiting_.empty() && running_.size() < static_cast<std::size_t>(shared_.jobs)) {
      const Waiting next = waiting_.front();
      double taken = std::max(next.memory, 0.0);
      bool is_alone = next.memory < 0;
      for (const Running& job : running_) {
        taken += std::max(job.memory, 0.0);
        is_alone = is_alone || job.memory < 0;
      }
      if (!running_.empty() && (is_alone || taken > available_)) return;
      waiting_.erase(waiting_.begin());
      start(next);
    }
  }

  std::string report_of(std::size_t index) const {
    const std::string& own = jobs_[index].arguments.report;
    return own.empty() ? (folder_ / fmt::format("{}.json", index)).string() : own;
  }

  void start(const Waiting& job) {
    std::vector<std::string> words = jobs_[job.index].words;
    words.insert(words.begin(), "warp");
    words.emplace_back("--quiet");
    if (jobs_[job.index].arguments.report.empty()) {
      words.push_back("--report=" + report_of(job.index));
    }
    if (jobs_[job.index].arguments.warp.threads == 0) {
      words.push_back(fmt::format("--threads={}", std::max(1, thread_count(0) / shared_.jobs)));
    }
    running_.push_back({job.index, job.memory, std::make_unique<JobProcess>(words)});
  }

  /// Reports the jobs that have ended. @returns whether there are any
  bool take_ended() {
    bool is_any = false;
    for (std::size_t n = 0; n < running_.size();) {
      if (!running_[n].process->has_ended()) {
        ++n;
        continue;
      }
      report_end(running_[n]);
      running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(n));
      write_report(shared_.report, outcome_, waiting_.empty() && running_.empty());
      is_any = true;
    }
    return is_any;
  }

  void report_end(const Running& job) {
    const std::string name = name_of_job(number_of(job.index));
    Json report = files_of_job(jobs_[job.index], number_of(job.index));
    const ProcessEnd& end = job.process->end();
    if (end.exit_code == interrupted_exit_code) {
      report["status"] = "interrupted";
      outcome_.reports.push_back(report);
      return;
    }
    if (end.exit_code != 0) {
      fail(outcome_, name, report,
           end.problem.empty() ? fmt::format("ended with code {}", end.exit_code) : end.problem);
      return;
    }
    std::ifstream file(report_of(job.index));
    report.update(Json::parse(file));
    const bool is_skipped = report.value("status", "") == "skipped";
    ++(is_skipped ? outcome_.skipped : outcome_.done);
    outcome_.reports.push_back(report);
    if (shared_.quiet) return;
    for (const Json& warning : report["warnings"]) {
      fmt::print(stderr, "tetwarp: {}: warning: {}\n", name, warning.get<std::string>());
    }
    fmt::print("{}: {}, {:.2f} s: {}\n", name, report.value("status", ""),
               report["timings"].value("total", 0.0), report.value("output", ""));
  }

  const std::vector<BatchJob>& jobs_;
  const WarpArguments& shared_;
  Outcome& outcome_;
  std::filesystem::path folder_;  ///< of the jobs' reports
  double available_ = 0;          ///< [byte] when the batch began
  std::vector<Waiting> waiting_;
  std::vector<Running> running_;
};

void run_one_by_one(const std::vector<BatchJob>& jobs,
                    const WarpArguments& shared,
                    Outcome& outcome) {
  for (std::size_t j = 0; j < jobs.size() && !is_interrupted(); ++j) {
    run_job(jobs[j], static_cast<int>(j) + 1, shared.quiet, outcome);
    write_report(shared.report, outcome, j + 1 == jobs.size() && !is_interrupted());
  }
}
}  // namespace

int run_batch(const WarpArguments& shared, const CLI::App& defaults) {
  const InterruptFlag interrupts_set_a_flag;
  const std::vector<BatchJob> jobs = read_batch(shared.batch, defaults);
  check_collisions(jobs, shared);
  Outcome outcome;
  if (shared.jobs > 1 && !shared.dry_run) {
    SideBySide(jobs, shared, outcome).run();
    write_report(shared.report, outcome, !is_interrupted());
  } else {
    run_one_by_one(jobs, shared, outcome);
  }
  if (!shared.quiet) {
    fmt::print("{} done, {} failed, {} skipped\n", outcome.done, outcome.failed, outcome.skipped);
  }
  stop_if_interrupted();
  return outcome.failed > 0 ? 1 : 0;
}

}  // namespace tetwarp::cli
