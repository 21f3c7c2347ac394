/// @file step_cases.hpp
/// The rows of single warp steps, as data, and the names of all rows.
#pragma once
#include <string>
#include <vector>

#include <tetwarp/names.hpp>
#include <tetwarp/warp.hpp>

#include "bench/measure/program.hpp"
#include "bench/measure/timing.hpp"
#include "bench/warp/workloads.hpp"

namespace tetwarp::bench {

/// One timed step.
struct StepCase {
  Workload workload;
  Filter filter = Filter::linear;
  PixelType type = PixelType::float32;
  Backend backend = Backend::cpu;
  int threads = 1;
  int components = 1;
  Image image = Image::textured;
  std::string without = {};  ///< what is switched off: a name of skip_variants(), `two_corners`
                             ///< (for SkipOptions::grid_point_masks), or empty
  SkipOptions skip = {};
};

/// W2_rotated_256/linear/float32/cpu/threads:2/without:culling; of several components: float32x3
std::string name_of(const StepCase& step_case);

/// Switches of SkipOptions that change one step in memory, off one by one or together.
struct SkipVariant {
  std::string name;
  SkipOptions skip;
};
std::vector<SkipVariant> skip_variants();

/// Which rows to register.
struct Selection {
  Extent extent;
  int threads;     ///< of the processor
  bool with_cuda;  ///< a CUDA device can be used

  bool is_full() const { return extent == Extent::full; }
  std::vector<Backend> backends() const;  ///< cpu, and cuda where it can be used
};

/// The end of a row's name: cpu/threads:2 or cuda.
std::string place_of(Backend backend, int threads);

/// Repetitions on cpu count only if they had nearly all of `threads` processors.
/// @param seconds  of a repetition; three of those that take over a second are enough, one of those
///                 that take over ten
Protocol protocol_for(Backend backend, int threads, double seconds = 0);

/// The rows of add_step_rows(), those of one input next to each other.
std::vector<StepCase> step_cases(const Selection& selection);

}  // namespace tetwarp::bench
