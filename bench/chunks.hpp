/// @file chunks.hpp
/// Writing outputs of which much is background.
#pragma once
#include "bench/warp_cases.hpp"

namespace tetwarp::bench {

/// Registers rows chunks/WORKLOAD: the output of a step written to a file, in the folder of
/// temporary files, without its chunks of background; timed in turn with writing all of them. Both
/// files must hold the step's samples. Beside the counters of a Timing:
///
///   whole             writing every chunk [ms]
///   cost_share        time / whole
///   background_share  chunks of background / chunks
///   megabytes         of the file
///   whole_megabytes   of the file with every chunk
void register_chunk_rows(int threads);

}  // namespace tetwarp::bench
