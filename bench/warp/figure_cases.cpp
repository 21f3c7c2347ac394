#include "bench/warp/figure_cases.hpp"

namespace tetwarp::bench {

std::vector<Workload> figure_workloads() {
  std::vector<Workload> workloads;
  for (const std::int64_t n : {128, 256, 384, 512}) workloads.push_back(rotated(n));
  for (const int tets : {40, 135, 320, 2560, 5000}) workloads.push_back(rotated(384, tets));
  return workloads;
}

std::string name_of(const PaperCase& row) {
  return "paper/" + row.workload.name + "/linear/float32/" + place_of(row.backend, row.threads) +
         (row.with_cells ? "" : "/without:cells");
}

std::vector<PaperCase> paper_cases(const Selection& selection) {
  std::vector<Workload> workloads = {torso_700(), orange_160(), fish_35()};
  if (selection.is_full()) {
    for (const Workload& workload : figure_workloads()) workloads.push_back(workload);
  }
  std::vector<PaperCase> rows;
  for (const Workload& workload : workloads) {
    for (const Backend backend : selection.backends()) {
      for (const bool with_cells : {true, false}) {
        rows.push_back({workload, with_cells, backend, selection.threads});
      }
    }
  }
  return rows;
}

}  // namespace tetwarp::bench
