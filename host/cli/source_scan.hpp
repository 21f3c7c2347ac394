/// @file source_scan.hpp
/// What must be known of a source before a part of it is warped, found in one pass over its file.
#pragma once
#include <vector>

#include <tetwarp/io.hpp>

#include "host/cli/fingerprint.hpp"

namespace tetwarp::cli {

/// Adds a source as Fingerprint::add(Volume) does, holding at most `bytes` of it at a time, but one
/// row at least.
/// @returns least and largest sample per component, in turns, NaN left out, when `wants_range`;
///          else nothing
std::vector<double> scan_source(const VolumeReader& source,
                                double bytes,
                                bool wants_range,
                                Fingerprint& fingerprint);

}  // namespace tetwarp::cli
