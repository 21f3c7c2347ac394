/// @file test_report.cpp
/// The report as JSON, whose field names are stable.
#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include <tetwarp/report.hpp>
#include <tetwarp/version.hpp>

#include "tests/support/json_names.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
using Json = nlohmann::json;
using Names = std::set<std::string>;

Report report_of_two_steps() {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 24);
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::uint8);
  WarpOptions options;
  options.backend = Backend::cpu;
  options.threads = 2;
  Warper warper(source, scene.mesh, options);
  warper.step(scene.deformed);
  warper.step(scene.mesh.rest_positions);
  return warper.report();
}

// In the order of the members.
constexpr std::array time_names = {"read",   "upload", "setup",    "mask",  "cull",
                                   "raster", "fields", "download", "write", "total"};
constexpr std::array count_names = {"voxels",
                                    "covered",
                                    "outside",
                                    "tetrahedra",
                                    "inverted",
                                    "flat",
                                    "folded",
                                    "cells",
                                    "candidate_pairs",
                                    "pairs_rejected",
                                    "pairs_accepted",
                                    "pairs_partial",
                                    "inside_tests",
                                    "exact_tests",
                                    "steps_unchanged",
                                    "tets_unchanged",
                                    "cells_unchanged",
                                    "cells_constant",
                                    "voxels_copied",
                                    "voxels_straightened",
                                    "chunks_background",
                                    "tets_averaged",
                                    "values_clipped",
                                    "blocks",
                                    "bytes_read",
                                    "bytes_written"};

TEST(Report, HasTheseFieldsAndNoOthers) {
  const Json json = Json::parse(to_json(report_of_two_steps()));

  EXPECT_EQ(names_of(json), (Names{"version", "backend", "backend_reason", "device", "threads",
                                   "position_quantum", "timings", "counts", "steps"}));
  EXPECT_EQ(names_of(json["timings"]), Names(time_names.begin(), time_names.end()));
  EXPECT_EQ(names_of(json["counts"]), Names(count_names.begin(), count_names.end()));
  EXPECT_EQ(names_of(json["steps"][0]), (Names{"step", "timings", "counts"}));
  EXPECT_EQ(names_of(json["steps"][0]["counts"]), names_of(json["counts"]));
  EXPECT_EQ(names_of(json["steps"][0]["timings"]), names_of(json["timings"]));
}

TEST(Report, NamesWhatRanAndWhere) {
  const Json json = Json::parse(to_json(report_of_two_steps()));

  EXPECT_EQ(json["version"], TETWARP_VERSION);
  EXPECT_EQ(json["backend"], "cpu");
  EXPECT_EQ(json["backend_reason"], "requested");
  EXPECT_EQ(json["threads"], 2);
  EXPECT_EQ(json["position_quantum"], 0x1p-20);
  EXPECT_FALSE(json["device"].get<std::string>().empty());
}

TEST(Report, SumsCountsAndTimesOverSteps) {
  const Json json = Json::parse(to_json(report_of_two_steps()));

  ASSERT_EQ(json["steps"].size(), 2u);
  for (const auto& [name, sum] : json["counts"].items()) {
    const std::int64_t steps = json["steps"][0]["counts"][name].get<std::int64_t>() +
                               json["steps"][1]["counts"][name].get<std::int64_t>();
    EXPECT_EQ(sum, steps) << name;
  }
  for (const auto& [name, sum] : json["timings"].items()) {
    const double steps = json["steps"][0]["timings"][name].get<double>() +
                         json["steps"][1]["timings"][name].get<double>();
    EXPECT_NEAR(sum, steps, 1e-12) << name;
  }
  EXPECT_GT(json["timings"]["raster"], 0);
  EXPECT_LE(json["timings"]["raster"], json["timings"]["total"]);
}

/// Each field is in the entry of its name; all values differ.
TEST(Report, MixesUpNoField) {
  Report report;
  report.backend = Backend::reference;
  report.timings = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
  report.counts = {1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13,
                   14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26};
  report.timings += report.timings;
  report.counts += report.counts;

  const Json json = Json::parse(to_json(report));

  int value = 0;
  for (const char* name : count_names) {
    EXPECT_EQ(json["counts"][name], value += 2) << name;
  }
  value = 0;
  for (const char* name : time_names) {
    EXPECT_EQ(json["timings"][name], value += 2) << name;
  }
  EXPECT_EQ(json["backend"], "reference");
}

TEST(Report, NamesTheBackends) {
  EXPECT_STREQ(name_of(Backend::automatic), "auto");
  EXPECT_STREQ(name_of(Backend::cuda), "cuda");
  EXPECT_STREQ(name_of(Backend::cpu), "cpu");
  EXPECT_STREQ(name_of(Backend::reference), "reference");
}

TEST(Report, ListsTheBackendsOfThisMachine) {
  const std::vector<BackendStatus> backends = available_backends();

  ASSERT_EQ(backends.size(), 3u);
  EXPECT_EQ(backends[0].backend, Backend::cuda);
  EXPECT_EQ(backends[0].reason.empty(), backends[0].usable);
  EXPECT_EQ(backends[0].device.empty(), !backends[0].usable);
  EXPECT_TRUE(backends[1].usable && backends[1].backend == Backend::cpu);
  EXPECT_TRUE(backends[2].usable && backends[2].backend == Backend::reference);
}
}  // namespace
}  // namespace tetwarp::test
