/// @file report_exchange.hpp
/// Reports as text, for ranks to send to the root.
#pragma once
#include <string>

#include <tetwarp/report.hpp>

#include "host/cli/job/job_result.hpp"

namespace tetwarp::cli {

/// A step as JSON, read by step_report_of().
std::string text_of(const StepReport& step);
StepReport step_report_of(const std::string& text);

/// What a rank did as JSON: sums, steps and counts of outputs.
std::string text_of(const JobResult& result);

/// Adds what another rank did, read from its text, to a result.
void add_text_to(JobResult& result, const std::string& text);

}  // namespace tetwarp::cli
