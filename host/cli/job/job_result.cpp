/// @file job_result.cpp
/// Keeps and prints what a job has to say.
#include "host/cli/job/job_result.hpp"

namespace tetwarp::cli {
namespace {
/// The name of a job of a batch; empty: there is one job.
std::string name_of_job(const JobContext& context) {
  return context.label == JobContext{}.label ? "" : context.label;
}
}  // namespace

void add_warnings(const Warnings& warnings, const JobContext& context, JobResult& result) {
  if (context.shows_progress) print_warnings(warnings, name_of_job(context));
  append(result.warnings, warnings);
}

void add_notes(const Warnings& notes, const JobContext& context, JobResult& result) {
  if (context.shows_progress) print_notes(name_of_job(context), notes);
  append(result.notes, notes);
}

}  // namespace tetwarp::cli
