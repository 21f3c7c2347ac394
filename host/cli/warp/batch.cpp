/// @file batch.cpp
/// Runs the jobs of a batch one after the other and reports each.
#include "host/cli/warp/batch.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <tetwarp/error.hpp>
#include <tetwarp/version.hpp>

#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/common/interrupt.hpp"
#include "host/cli/common/json_text.hpp"
#include "host/cli/job/job_plan.hpp"
#include "host/cli/warp/batch_file.hpp"
#include "host/cli/warp/warp_job.hpp"
#include "io/files/finished_file.hpp"

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

/// The files that a job will write. Where planning fails, e.g. because an earlier job makes the
/// input, the output that the job names.
std::vector<std::string> files_written(const BatchJob& job) {
  if (!job.error.empty()) return {};
  std::vector<std::string> files;
  try {
    files = plan_job(job.arguments).outputs();
  } catch (const std::exception&) {
    files = {job.arguments.output};
  }
  if (!job.arguments.report.empty()) files.push_back(job.arguments.report);
  return files;
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

void run_job(const BatchJob& job, int number, bool quiet, Outcome& outcome) {
  const std::string name = fmt::format("job {}", number);
  Json report{
      {"job", number}, {"volumes", job.volumes}, {"mesh", job.mesh}, {"output", job.output}};
  if (!job.error.empty()) {
    fail(outcome, name, report, job.error);
    return;
  }
  try {
    const JobResult result = run_warp_job(job.arguments, {.label = name, .shows_progress = !quiet});
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
}  // namespace

int run_batch(const WarpArguments& shared, const CLI::App& defaults) {
  const InterruptFlag interrupts_set_a_flag;
  const std::vector<BatchJob> jobs = read_batch(shared.batch, defaults);
  check_collisions(jobs, shared);
  Outcome outcome;
  for (std::size_t j = 0; j < jobs.size() && !is_interrupted(); ++j) {
    run_job(jobs[j], static_cast<int>(j) + 1, shared.quiet, outcome);
    write_report(shared.report, outcome, j + 1 == jobs.size() && !is_interrupted());
  }
  if (!shared.quiet) {
    fmt::print("{} done, {} failed, {} skipped\n", outcome.done, outcome.failed, outcome.skipped);
  }
  stop_if_interrupted();
  return outcome.failed > 0 ? 1 : 0;
}

}  // namespace tetwarp::cli
