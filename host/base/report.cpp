/// @file report.cpp
/// Sums of counts and times, and a report as JSON.
#include <nlohmann/json.hpp>
#include <tetwarp/report.hpp>

#include "host/base/report_fields.hpp"

namespace tetwarp {
namespace {
using Json = nlohmann::ordered_json;

template <class Record, class Fields>
Json json_of(const Record& record, const Fields& fields) {
  Json json;
  for (const auto& [name, member] : fields) json[name] = record.*member;
  return json;
}

template <class Record, class Fields>
void add_to(Record& record, const Record& other, const Fields& fields) {
  for (const auto& [name, member] : fields) record.*member += other.*member;
}
}  // namespace

Timings& Timings::operator+=(const Timings& other) {
  add_to(*this, other, timing_fields);
  return *this;
}

Counts& Counts::operator+=(const Counts& other) {
  add_to(*this, other, count_fields);
  return *this;
}

double Totals::relative_change(std::size_t component) const {
  const double change = rounding[component] + clipping[component];
  return change == 0 ? 0 : change / (after[component] - change);
}

std::string to_json(const Report& report) {
  Json steps = Json::array();
  for (const StepReport& step : report.steps) {
    steps.push_back({{"step", step.step},
                     {"timings", json_of(step.timings, timing_fields)},
                     {"counts", json_of(step.counts, count_fields)}});
    if (step.totals.before.empty()) continue;
    steps.back()["total_before"] = step.totals.before;
    steps.back()["total_after"] = step.totals.after;
    if (step.totals.rounding.empty()) continue;
    steps.back()["total_rounding"] = step.totals.rounding;
    steps.back()["total_clipping"] = step.totals.clipping;
    for (std::size_t c = 0; c < step.totals.after.size(); ++c) {
      steps.back()["total_relative_change"].push_back(step.totals.relative_change(c));
    }
  }
  const Json json = {{"version", report.version},
                     {"backend", name_of(report.backend)},
                     {"backend_reason", report.backend_reason},
                     {"device", report.device},
                     {"threads", report.threads},
                     {"position_quantum", report.position_quantum},
                     {"timings", json_of(report.timings, timing_fields)},
                     {"counts", json_of(report.counts, count_fields)},
                     {"steps", steps}};
  return json.dump(2);
}

}  // namespace tetwarp
