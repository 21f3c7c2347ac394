/// @file backend_cpu.cpp
/// Back end cpu: the pipeline on host threads.
#include <fstream>
#include <string>

#include "host/base/parallel.hpp"
#include "host/exec/exec_cpu.hpp"
#include "host/warp/cpu/cell_cull_cpu.hpp"
#include "host/warp/cpu/cell_raster_cpu.hpp"
#include "host/warp/cpu/overlap_stage_cpu.hpp"
#include "host/warp/stages/warp_pipeline.hpp"

namespace tetwarp {

namespace {

std::string read_processor_name() {
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown processor";
}

}  // namespace

std::string processor_name() {
  static const std::string name = read_processor_name();  // reading it takes longer than a solve
  return name;
}

std::unique_ptr<WarpBackend> make_cpu_backend(const WarpPlan& plan) {
  return std::make_unique<WarpPipeline<CpuExec>>(plan, CpuExec(thread_count(plan.options.threads)));
}

}  // namespace tetwarp
