/// @file warp_cases.hpp
/// The rows of the benchmark, as data.
#pragma once
#include <string>
#include <vector>

#include <tetwarp/warp.hpp>

#include "bench/workloads.hpp"

namespace tetwarp::bench {

/// One timed step.
struct WarpCase {
  Workload workload;
  Filter filter = Filter::linear;
  PixelType type = PixelType::float32;
  Backend backend = Backend::cpu;
  int threads = 1;
  int components = 1;
  Image image = Image::textured;
  std::string without = {};  ///< what is switched off: a name of skip_variants(), or nothing
  SkipOptions skip = {};
};

/// As on the command line.
const char* name_of(Filter filter);

/// W2_rotated_256/linear/float32/cpu/threads:2/without:culling; of several components: float32x3
std::string name_of(const WarpCase& warp_case);

/// Switches of SkipOptions that change one step in memory, off one by one or together.
struct SkipVariant {
  std::string name;
  SkipOptions skip;
};
std::vector<SkipVariant> skip_variants();

/// What to measure.
enum class Extent {
  brief,  ///< a few minutes on two cores, enough for every plot
  full
};

/// The rows for a processor with `threads` threads, and for CUDA where `with_cuda`.
std::vector<WarpCase> warp_cases(Extent extent, int threads, bool with_cuda);

}  // namespace tetwarp::bench
