/// @file operator_plan.hpp
/// The arguments of a WarpOperator as the plan of a warp.
#pragma once
#include <tetwarp/warp_operator.hpp>

#include "host/base/warp_backend.hpp"

namespace tetwarp {

/// @returns a plan without samples
/// @throws std::invalid_argument  on any bad argument, naming it
WarpPlan operator_plan(const Grid& source, const Mesh& mesh, const WarpOperatorOptions& options);

}  // namespace tetwarp
