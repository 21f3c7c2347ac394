/// @file report_exchange.cpp
/// Reports to JSON and back.
#include "host/cli/warp/volumes/report_exchange.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "host/base/report_fields.hpp"

namespace tetwarp::cli {
namespace {
using Json = nlohmann::ordered_json;

template <class Record, class Fields>
Record record_of(const Json& json, const Fields& fields) {
  Record record;
  for (const auto& [name, member] : fields) json.at(name).get_to(record.*member);
  return record;
}

/// Numbers of a list; JSON stores those that are not finite as null.
std::vector<double> numbers_of(const Json& list) {
  std::vector<double> numbers(list.size());
  std::ranges::transform(list, numbers.begin(), [](const Json& number) {
    return number.is_null() ? std::numeric_limits<double>::quiet_NaN() : number.get<double>();
  });
  return numbers;
}

StepReport step_of(const Json& json) {
  StepReport step;
  json.at("step").get_to(step.step);
  step.timings = record_of<Timings>(json.at("timings"), timing_fields);
  step.counts = record_of<Counts>(json.at("counts"), count_fields);
  if (json.contains("total_before")) {
    step.totals.before = numbers_of(json["total_before"]);
    step.totals.after = numbers_of(json["total_after"]);
  }
  if (json.contains("total_rounding")) {
    step.totals.rounding = numbers_of(json["total_rounding"]);
    step.totals.clipping = numbers_of(json["total_clipping"]);
  }
  return step;
}
}  // namespace

std::string text_of(const StepReport& step) {
  Report report;
  report.steps.push_back(step);
  return to_json(report);
}

StepReport step_report_of(const std::string& text) {
  return step_of(Json::parse(text).at("steps").at(0));
}

std::string text_of(const JobResult& result) {
  Json json = Json::parse(to_json(result.report));
  json["written"] = result.written;
  json["skipped"] = result.skipped;
  return json.dump();
}

void add_text_to(JobResult& result, const std::string& text) {
  const Json json = Json::parse(text);
  Report& report = result.report;
  report.timings += record_of<Timings>(json.at("timings"), timing_fields);
  report.counts += record_of<Counts>(json.at("counts"), count_fields);
  for (const Json& step : json.at("steps")) report.steps.push_back(step_of(step));
  result.written += json.at("written").get<std::int64_t>();
  result.skipped += json.at("skipped").get<std::int64_t>();
}

}  // namespace tetwarp::cli
