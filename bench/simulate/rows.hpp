/// @file rows.hpp
/// Rows of tetwarp_bench_simulate: steps of an elastic block, and products with its system.
///
/// step/tets:N/threads:T     time of a whole step; counters forces, assembly, linear, update [ms],
///                           iterations of conjugate gradients
/// step/tets:N/cuda          the same on a device; results must agree with back end cpu to 1e-6
/// product/tets:N/threads:T  one product with the block matrix; counters bytes, rate [byte/s] and
///                           copy_share: the time of reading and writing as many bytes by copying
///                           over that of the product, both the least of rounds in turn
#pragma once
#include "bench/measure/program.hpp"

namespace tetwarp::bench {

/// @param with_cuda  adds rows of back end cuda
void add_simulate_rows(Extent extent, bool with_cuda);

}  // namespace tetwarp::bench
