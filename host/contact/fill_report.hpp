/// @file fill_report.hpp
/// Counts and residuals of a solve in its report.
#pragma once
#include <tetwarp/contact.hpp>

#include "host/contact/solve/engine_result.hpp"
#include "host/contact/solve/status.hpp"

namespace tetwarp {

/// Sets the counts and residuals of a report; not the balance, the status and the times.
void fill_report(const EngineResult& result,
                 const WholeResidual& whole,
                 ContactMeasure measure,
                 ContactReport& report);

}  // namespace tetwarp
