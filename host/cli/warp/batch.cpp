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
#include <memory>
#include <nlohmann/json.hpp>
#include <tetwarp/error.hpp>
#include <tetwarp/version.hpp>
#include <thread>
#include <utility>

#include "host/base/parallel.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/interrupt.hpp"
#include "host/cli/common/json_text.hpp"
#include "host/cli/warp/batch_file.hpp"
#include "host/cli/warp/batch_order.hpp"
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

/// What the report says of a job before it runs.
Json report_head(const BatchJob& job, int number) {
  Json files{{"job", number}, {"volumes", job.volumes}, {"mesh", job.mesh}, {"output", job.output}};
  if (!job.left_out.empty()) files["defaults_left_out"] = job.left_out;
  return files;
}

JobResult run_by_kind(const WarpArguments& arguments, const JobContext& context) {
  return names_transform(arguments) ? run_transform_job(arguments, context)
                                    : run_warp_job(arguments, context);
}

std::string summary_by_kind(const WarpArguments& arguments, const JobResult& result) {
  return names_transform(arguments) ? transform_summary(arguments, result) : summary(result);
}

/// The state of a job: not ended, ended, ended by an error.
enum class JobState { open, ended, failed };

/// Why a job is not run: an earlier one, which was to write an input of it, has failed. Empty: it
/// may run.
std::string missing_input(const std::vector<Wait>& waits, const std::vector<JobState>& states) {
  for (const Wait& wait : waits) {
    if (wait.input.empty() || states[wait.job] != JobState::failed) continue;
    return fmt::format("is not run: {} failed, which writes its input '{}'",
                       name_of_job(static_cast<int>(wait.job) + 1), wait.input);
  }
  return {};
}

void run_job(const BatchJob& job, int number, bool quiet, Outcome& outcome) {
  const std::string name = name_of_job(number);
  Json report = report_head(job, number);
  if (!job.error.empty()) {
    fail(outcome, name, report, job.error);
    return;
  }
  try {
    const JobResult result = run_by_kind(job.arguments, {.label = name, .shows_progress = !quiet});
    report.update(Json::parse(report_json(result)));
    if (!result.refusal.empty()) {
      if (!quiet) fmt::print("{}: {}", name, summary_by_kind(job.arguments, result));
      fail(outcome, name, report, result.refusal);
      return;
    }
    ++(result.written == 0 && result.plans.empty() ? outcome.skipped : outcome.done);
    outcome.reports.push_back(report);
    if (!quiet) fmt::print("{}: {}", name, summary_by_kind(job.arguments, result));
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
  /// @param waits     of waits_of_jobs()
  /// @param defaults  as of read_batch()
  SideBySide(std::vector<BatchJob>& jobs,
             std::vector<std::vector<Wait>> waits,
             const WarpArguments& shared,
             const CLI::App& defaults,
             Outcome& outcome)
      : jobs_(jobs),
        waits_(std::move(waits)),
        states_(jobs.size(), JobState::open),
        shared_(shared),
        defaults_(defaults),
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
      Json report = report_head(jobs_[job.index], number_of(job.index));
      report["status"] = "interrupted";
      outcome_.reports.push_back(report);
    }
  }

 private:
  struct Waiting {
    std::size_t index;
    double memory;    ///< -1: not known
    bool is_planned;  ///< false: the files that earlier jobs write for it were not complete
  };
  struct Running {
    std::size_t index;
    double memory;
    std::unique_ptr<JobProcess> process;
  };

  static int number_of(std::size_t index) { return static_cast<int>(index) + 1; }

  /// Plans the memory of all jobs and states it.
  void plan() {
    std::vector<double> sizes;
    for (std::size_t j = 0; j < jobs_.size(); ++j) {
      stop_if_interrupted();
      if (!jobs_[j].error.empty()) {
        refuse(j, jobs_[j].error);
        continue;
      }
      const double memory = planned_memory(jobs_[j]);
      waiting_.push_back({j, memory, waits_[j].empty()});
      sizes.push_back(std::max(memory, 0.0));
    }
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

  void refuse(std::size_t index, const std::string& reason) {
    states_[index] = JobState::failed;
    fail(outcome_, name_of_job(number_of(index)), report_head(jobs_[index], number_of(index)),
         reason);
  }

  /// Whether a job fits beside those that run. One that cannot be planned runs alone.
  bool fits(const Waiting& next) const {
    double taken = std::max(next.memory, 0.0);
    bool is_alone = next.memory < 0;
    for (const Running& job : running_) {
      taken += std::max(job.memory, 0.0);
      is_alone = is_alone || job.memory < 0;
    }
    return running_.empty() || (!is_alone && taken <= available_);
  }

  /// Starts jobs in their order; those that have to wait for others are passed over.
  void start_some() {
    for (std::size_t n = 0;
         n < waiting_.size() && running_.size() < static_cast<std::size_t>(shared_.jobs);) {
      Waiting& next = waiting_[n];
      const std::vector<Wait>& waits = waits_[next.index];
      const auto is_open = [&](const Wait& wait) { return states_[wait.job] == JobState::open; };
      if (std::ranges::any_of(waits, is_open)) {
        ++n;
        continue;
      }
      const std::string problem = problem_of(next, waits);
      if (!problem.empty()) {
        refuse(next.index, problem);
      } else {
        if (!fits(next)) return;
        start(next);
      }
      waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(n));
    }
  }

  /// Why a job that has waited is not run; reads and plans it again, where it is. Empty: it is run.
  std::string problem_of(Waiting& next, const std::vector<Wait>& waits) {
    if (next.is_planned) return {};
    std::string missing = missing_input(waits, states_);
    if (!missing.empty()) return missing;
    BatchJob& job = jobs_[next.index];
    read_again(shared_.batch, defaults_, job);
    if (!job.error.empty()) return job.error;
    next.memory = planned_memory(job);
    next.is_planned = true;
    return {};
  }

  std::string report_of(std::size_t index) const {
    const std::string& own = jobs_[index].arguments.report;
    return own.empty() ? (folder_ / fmt::format("{}.json", index)).string() : own;
  }

  void start(const Waiting& job) {
    std::vector<std::string> words = jobs_[job.index].words;
    words.insert(words.begin(), "warp");
    if (shared_.quiet) words.emplace_back("--quiet");
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
    Json report = report_head(jobs_[job.index], number_of(job.index));
    const ProcessEnd& end = job.process->end();
    states_[job.index] = end.exit_code == 0 ? JobState::ended : JobState::failed;
    if (end.exit_code == interrupted_exit_code) {
      report["status"] = "interrupted";
      outcome_.reports.push_back(report);
      return;
    }
    for (const std::string& line : end.notes) fmt::print(stderr, "tetwarp: {}: {}\n", name, line);
    for (const std::string& line : end.printed) fmt::print("{}: {}\n", name, line);
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
  }

  std::vector<BatchJob>& jobs_;
  std::vector<std::vector<Wait>> waits_;
  std::vector<JobState> states_;
  const WarpArguments& shared_;
  const CLI::App& defaults_;
  Outcome& outcome_;
  std::filesystem::path folder_;  ///< of the jobs' reports
  double available_ = 0;          ///< [byte] when the batch began
  std::vector<Waiting> waiting_;
  std::vector<Running> running_;
};

void run_one_by_one(std::vector<BatchJob>& jobs,
                    const std::vector<std::vector<Wait>>& waits,
                    const WarpArguments& shared,
                    const CLI::App& defaults,
                    Outcome& outcome) {
  std::vector<JobState> states(jobs.size(), JobState::open);
  for (std::size_t j = 0; j < jobs.size() && !is_interrupted(); ++j) {
    const int number = static_cast<int>(j) + 1, failed = outcome.failed;
    const std::string missing = missing_input(waits[j], states);
    if (missing.empty()) {
      if (!waits[j].empty() && jobs[j].error.empty()) read_again(shared.batch, defaults, jobs[j]);
      run_job(jobs[j], number, shared.quiet, outcome);
    } else {
      fail(outcome, name_of_job(number), report_head(jobs[j], number), missing);
    }
    states[j] = outcome.failed > failed ? JobState::failed : JobState::ended;
    write_report(shared.report, outcome, j + 1 == jobs.size() && !is_interrupted());
  }
}
}  // namespace

int run_batch(const WarpArguments& shared, const CLI::App& defaults) {
  const InterruptFlag interrupts_set_a_flag;
  std::vector<BatchJob> jobs = read_batch(shared.batch, defaults);
  const std::vector<JobFiles> files = files_of_jobs(jobs);
  check_collisions(jobs, files, shared);
  const std::vector<std::vector<Wait>> waits = waits_of_jobs(files);
  Outcome outcome;
  if (shared.jobs > 1 && !shared.dry_run) {
    SideBySide(jobs, waits, shared, defaults, outcome).run();
    write_report(shared.report, outcome, !is_interrupted());
  } else {
    run_one_by_one(jobs, waits, shared, defaults, outcome);
  }
  if (!shared.quiet) {
    fmt::print("{} done, {} failed, {} skipped\n", outcome.done, outcome.failed, outcome.skipped);
  }
  stop_if_interrupted();
  return outcome.failed > 0 ? 1 : 0;
}

}  // namespace tetwarp::cli
