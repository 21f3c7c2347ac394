/// @file rows.hpp
/// Rows of tetwarp_bench_simulate: steps of an elastic block, products with its system, and what
/// cells, steps and tolerances cost and gain.
///
/// step/tets:N/threads:T     time of a whole step; counters forces, assembly, linear, update [ms],
///                           iterations of conjugate gradients
/// step/tets:N/cuda          the same on a device; results must agree with back end cpu to 1e-6
/// product/tets:N/threads:T  one product with the block matrix; counters bytes, rate [byte/s] and
///                           copy_share: the time of reading and writing as many bytes by copying
///                           over that of the product, both the least of rounds in turn
///
/// bend/cells:N         a cantilever, N cells thick, bent by its weight, at rest after 5 s; time of
///                      a step of 5 ms; tip: deflection over Timoshenko's, error: |1 - tip|
/// swing/step:X         the same of 2 cells, released without damping, after 1 s; error of the tip
///                      against the limit of short steps; ms_per_second: of simulated time
/// momentum/tolerance:T one step of 8 ms of a free block of 10,985 tetrahedra, E = 1e7 Pa; error:
///                      change of momentum over the sum of |m v|
///
/// touch/SCENE/size:N/threads:T  time of a step with contact: cloth of N x N cells, N x N rigid
///                      stones or elastic balls on a floor; counters contacts, passes, sweeps,
///                      unconverged (steps above their tolerance) and the stages forces, assembly,
///                      linear, detection, contact, update [ms]
/// skip/WHAT/candies/size:N  the same steps with and without the work that SimulateSkipOptions
///                      leaves out; all: time with all of it, cost_share: of that, error: largest
///                      difference of positions over the thickness
#pragma once
#include "bench/measure/program.hpp"

namespace tetwarp::bench {

/// @param with_cuda  adds rows of back end cuda
void add_simulate_rows(Extent extent, bool with_cuda);
void add_error_rows(Extent extent);
void add_touch_rows(Extent extent);

}  // namespace tetwarp::bench
