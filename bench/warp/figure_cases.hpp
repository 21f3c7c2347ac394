/// @file figure_cases.hpp
/// Inputs and rows of two figures of Gascon et al. 2013: time against volume size (3.5 of the
/// thesis behind it) and against tetrahedra (3.6), by tetwarp and by the method of the paper.
#pragma once
#include <string>
#include <vector>

#include "bench/warp/step_cases.hpp"
#include "bench/warp/workloads.hpp"

namespace tetwarp::bench {

/// Rotated volumes of 128^3 to 512^3 samples in 1,080 tetrahedra, and of 384^3 samples, 234 million
/// output voxels, in 40 to 5,000.
std::vector<Workload> figure_workloads();

/// One timed step by the method of the paper.
struct PaperCase {
  Workload workload;
  bool with_cells = true;
  Backend backend = Backend::cpu;
  int threads = 1;
};

/// paper/W2_rotated_256/linear/float32/cpu/threads:2/without:cells
std::string name_of(const PaperCase& row);

/// The figures' workloads and those of the paper's volumes, with cells and without.
std::vector<PaperCase> paper_cases(const Selection& selection);

}  // namespace tetwarp::bench
