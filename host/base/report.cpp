/// @file report.cpp
#include <nlohmann/json.hpp>
#include <tetwarp/report.hpp>

namespace tetwarp {

namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Timings& t) {
  return {{"read", t.read},   {"upload", t.upload}, {"setup", t.setup},   {"mask", t.mask},
          {"cull", t.cull},   {"raster", t.raster}, {"fields", t.fields}, {"download", t.download},
          {"write", t.write}, {"total", t.total}};
}

Json json_of(const Counts& c) {
  return {{"voxels", c.voxels},
          {"covered", c.covered},
          {"outside", c.outside},
          {"tetrahedra", c.tetrahedra},
          {"inverted", c.inverted},
          {"flat", c.flat},
          {"folded", c.folded},
          {"cells", c.cells},
          {"candidate_pairs", c.candidate_pairs},
          {"pairs_rejected", c.pairs_rejected},
          {"pairs_accepted", c.pairs_accepted},
          {"pairs_partial", c.pairs_partial},
          {"inside_tests", c.inside_tests},
          {"exact_tests", c.exact_tests},
          {"steps_unchanged", c.steps_unchanged},
          {"tets_unchanged", c.tets_unchanged},
          {"cells_unchanged", c.cells_unchanged},
          {"cells_constant", c.cells_constant},
          {"voxels_copied", c.voxels_copied},
          {"chunks_background", c.chunks_background},
          {"tets_averaged", c.tets_averaged},
          {"blocks", c.blocks},
          {"bytes_read", c.bytes_read},
          {"bytes_written", c.bytes_written}};
}

}  // namespace

Timings& Timings::operator+=(const Timings& other) {
  read += other.read;
  upload += other.upload;
  setup += other.setup;
  mask += other.mask;
  cull += other.cull;
  raster += other.raster;
  fields += other.fields;
  download += other.download;
  write += other.write;
  total += other.total;
  return *this;
}

Counts& Counts::operator+=(const Counts& other) {
  voxels += other.voxels;
  covered += other.covered;
  outside += other.outside;
  tetrahedra += other.tetrahedra;
  inverted += other.inverted;
  flat += other.flat;
  folded += other.folded;
  cells += other.cells;
  candidate_pairs += other.candidate_pairs;
  pairs_rejected += other.pairs_rejected;
  pairs_accepted += other.pairs_accepted;
  pairs_partial += other.pairs_partial;
  inside_tests += other.inside_tests;
  exact_tests += other.exact_tests;
  steps_unchanged += other.steps_unchanged;
  tets_unchanged += other.tets_unchanged;
  cells_unchanged += other.cells_unchanged;
  cells_constant += other.cells_constant;
  voxels_copied += other.voxels_copied;
  chunks_background += other.chunks_background;
  tets_averaged += other.tets_averaged;
  blocks += other.blocks;
  bytes_read += other.bytes_read;
  bytes_written += other.bytes_written;
  return *this;
}

std::string to_json(const Report& report) {
  Json steps = Json::array();
  for (const StepReport& step : report.steps) {
    steps.push_back({{"step", step.step},
                     {"timings", json_of(step.timings)},
                     {"counts", json_of(step.counts)}});
    const Totals& totals = step.totals;
    for (std::size_t c = 0; c < totals.count; ++c) {
      steps.back()["total_before"].push_back(totals.before[c]);
      steps.back()["total_after"].push_back(totals.after[c]);
    }
  }
  const Json json = {{"version", report.version},
                     {"backend", name_of(report.backend)},
                     {"backend_reason", report.backend_reason},
                     {"device", report.device},
                     {"threads", report.threads},
                     {"position_quantum", report.position_quantum},
                     {"timings", json_of(report.timings)},
                     {"counts", json_of(report.counts)},
                     {"steps", steps}};
  return json.dump(2);
}

}  // namespace tetwarp
