/// @file step_second_fields.hpp
/// The members of StepSeconds with their names in reports.
#pragma once
#include <iterator>

#include <tetwarp/simulate.hpp>

#include "host/base/report_fields.hpp"

namespace tetwarp {

inline constexpr ReportField<StepSeconds, double> step_second_fields[] = {
    {"forces", &StepSeconds::forces},   {"assembly", &StepSeconds::assembly},
    {"linear", &StepSeconds::linear},   {"detection", &StepSeconds::detection},
    {"contact", &StepSeconds::contact}, {"update", &StepSeconds::update},
    {"total", &StepSeconds::total}};
static_assert(sizeof(StepSeconds) == sizeof(double) * std::size(step_second_fields),
              "the seconds of a stage are missing");

inline void add_seconds(const StepSeconds& part, StepSeconds& sum) {
  for (const auto& field : step_second_fields) sum.*field.member += part.*field.member;
}

}  // namespace tetwarp
