/// @file fields.hpp
/// What fields of the deformation cost beside a plain step, and how exact displacements are.
#pragma once
#include "bench/warp_cases.hpp"

namespace tetwarp::bench {

/// Rows fields/WORKLOAD/FIELD/cpu/threads:N: `plain` is the time of the step without the field,
/// taken in turn with it; `field_ns_per_covered` what the field adds; `max_error` that of the
/// displacement [voxel].
void register_field_rows(Extent extent, int threads);

}  // namespace tetwarp::bench
