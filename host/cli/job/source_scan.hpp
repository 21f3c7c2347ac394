/// @file source_scan.hpp
/// Reads a source that does not fit in memory once: for its fingerprint and range.
#pragma once
#include <vector>

#include <tetwarp/io.hpp>

#include "host/cli/job/fingerprint.hpp"

namespace tetwarp::cli {

/// Adds a source to a fingerprint as Fingerprint::add(Volume) does. Keeps at most `bytes` of it in
/// memory, but at least one row.
/// @returns smallest and largest sample of component 0, then of 1 and so on, NaN left out; empty
///          unless `needs_range`
std::vector<double> scan_source(const VolumeReader& source,
                                double bytes,
                                bool needs_range,
                                Fingerprint& fingerprint);

}  // namespace tetwarp::cli
