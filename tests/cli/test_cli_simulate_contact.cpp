/// @file test_cli_simulate_contact.cpp
/// `tetwarp simulate` with bodies that touch: series, files of contacts, fields, exit codes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/h5_numbers.hpp"
#include "tests/support/simulate_scene.hpp"

namespace tetwarp::test {
namespace {
using Numbers = std::vector<double>;

/// A soft block and a rigid box fall 2 mm onto a plane, which they reach after 20 ms.
constexpr const char* landing_scene = R"({
  "tetwarp_scene": 1, "time_step": 0.005, "duration": 0.15, "thickness": 1e-4,
  "contact": {"friction": 0.5},
  "bodies": [
    {"name": "soft", "kind": "fem", "shape": {"type": "box", "half": [0.05, 0.05, 0.05]},
     "lattice": {"cells": [2, 2, 2]}, "material": {"E": 1e5, "nu": 0.3, "density": 1000},
     "pose": {"position": [0, 0, 0.052]}},
    {"name": "box", "kind": "rigid", "shape": {"type": "box", "half": [0.05, 0.05, 0.05]},
     "density": 1000, "pose": {"position": [0.3, 0, 0.052]}}],
  "obstacles": [{"name": "floor", "plane": {"normal": [0, 0, 1]}}],
  "output": {"every": 3, "fields": ["contact"]}})";

class Landing : public SimulateScene {
 public:
  Landing() { write_text(*this / "scene.json", landing_scene); }
  Numbers series(const std::string& folder, const std::string& name) const {
    return h5_numbers(in(folder, "series.h5"), name);
  }
};

/// The sum of the vectors in rows [first, end) of a list of them.
std::array<double, 3> sum_of(const Numbers& vectors, std::size_t first, std::size_t end) {
  std::array<double, 3> sum{};
  for (std::size_t n = 3 * first; n < 3 * end; ++n) sum[n % 3] += vectors[n];
  return sum;
}

/// At rest the floor carries the weight of both bodies, 1 kg each.
TEST(SimulateContact, CountsMeasuresAndBalancesForces) {
  const Landing scene;

  const CommandResult result = scene.simulate({"-o", "out"});

  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Numbers contacts = scene.series("out", "contacts");
  EXPECT_EQ(contacts.front(), 0);
  EXPECT_GT(contacts.back(), 4);
  const Numbers nearest = scene.series("out", "smallest_distance");
  EXPECT_NEAR(nearest.front(), 2e-3, 1e-12);
  EXPECT_GT(*std::min_element(nearest.begin(), nearest.end()), 0);
  EXPECT_NEAR(nearest.back(), 1e-4, 2e-5) << "bodies rest at the thickness";
  const Numbers passes = scene.series("out", "contact_passes");
  EXPECT_EQ(passes.front(), 0);
  EXPECT_GE(*std::min_element(passes.begin() + 1, passes.end()), 1);
  EXPECT_GT(scene.series("out", "sweeps").back(), 0);
  EXPECT_LE(scene.series("out", "contact_residual").back(), 1e-4);
  for (const char* name : {"clamped_islands", "stalled_scripts", "adhered_area"}) {
    EXPECT_EQ(scene.series("out", name).back(), 0) << name;
  }
  const std::size_t rows = contacts.size();
  const auto force = [&](const std::string& name) {
    return sum_of(scene.series("out", name + "/contact_force"), rows - 1, rows);
  };
  EXPECT_NEAR(force("bodies/box")[2], 9.81, 0.02);
  EXPECT_NEAR(force("obstacles/floor")[2], -force("bodies/box")[2] - force("bodies/soft")[2], 1e-9);
}

TEST(SimulateContact, WritesContactsAsPoints) {
  const Landing scene;

  const CommandResult result = scene.simulate({"-o", "out", "--contacts", "touch.vtkhdf"});

  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string file = scene / "touch.vtkhdf";
  const auto numbers = [&](const std::string& name) { return h5_numbers(file, "VTKHDF/" + name); };
  const Numbers counts = numbers("NumberOfPoints"), first = numbers("Steps/PointOffsets");
  ASSERT_EQ(counts.size(), 11u);
  EXPECT_EQ(counts.front(), 0) << "nothing touches at the start";
  const Numbers series = scene.series("out", "contacts");
  for (std::size_t frame = 0; frame < counts.size(); ++frame) {
    EXPECT_EQ(counts[frame], series[3 * frame]) << frame;
  }
  const auto begin = static_cast<std::size_t>(first.back());
  const auto end = begin + static_cast<std::size_t>(counts.back());
  const Numbers points = numbers("Points"), normals = numbers("PointData/normal");
  const Numbers a = numbers("PointData/body_a"), b = numbers("PointData/body_b");
  for (std::size_t c = begin; c < end; ++c) {
    EXPECT_NEAR(points[3 * c + 2], 0.5e-4, 1e-4);
    EXPECT_NEAR(std::abs(normals[3 * c + 2]), 1, 1e-9);
    EXPECT_LT(std::min(a[c], b[c]), 2);
    EXPECT_EQ(std::max(a[c], b[c]), 2) << "the floor";
  }
  const Numbers impulses = numbers("PointData/impulse");
  double upward = 0;
  for (std::size_t c = begin; c < end; ++c) {
    upward += (a[c] == 2 ? -1 : 1) * impulses[3 * c + 2];
  }
  EXPECT_NEAR(upward / 0.005, 2 * 9.81, 0.2);
}

/// Impulses on the surface sum up to the force; where nothing touches the gap is the cap.
TEST(SimulateContact, WritesFieldsOnSurfaces) {
  const Landing scene;

  ASSERT_EQ(scene.simulate({"-o", "out"}).exit_code, 0);

  for (const char* name : {"soft", "box"}) {
    const std::string file = scene.in("out", std::string(name) + ".surface.vtkhdf");
    const auto numbers = [&](const std::string& array) {
      return h5_numbers(file, "VTKHDF/PointData/" + array);
    };
    const Numbers impulse = numbers("impulse"), gap = numbers("gap");
    const std::size_t points = gap.size() / 11;
    EXPECT_EQ(impulse.size(), 3 * gap.size());
    EXPECT_EQ(numbers("intensity"), Numbers(gap.size(), 0));
    for (std::size_t p = 0; p < points; ++p) EXPECT_DOUBLE_EQ(gap[p], 1e-2) << "at the start";
    EXPECT_LT(*std::min_element(gap.end() - static_cast<long>(points), gap.end()), 2e-5);
    EXPECT_DOUBLE_EQ(*std::max_element(gap.end() - static_cast<long>(points), gap.end()), 1e-2);
    const std::array<double, 3> sum = sum_of(impulse, 10 * points, 11 * points);
    const Numbers force = scene.series("out", "bodies/" + std::string(name) + "/contact_force");
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(sum[axis], 0.005 * force[force.size() - 3 + axis], 1e-9) << name;
    }
  }
}

/// A checkpoint while bodies touch: series, meshes and contacts are those of one run, and so they
/// are for another number of threads.
TEST(SimulateContact, GoesOnFromACheckpointBitForBit) {
  const Landing scene;
  ASSERT_EQ(scene.simulate({"-o", "whole", "--contacts", "whole.vtkhdf"}).exit_code, 0);
  ASSERT_EQ(scene
                .simulate({"-o", "parts", "--contacts", "parts.vtkhdf", "--steps", "20",
                           "--checkpoint", "state"})
                .exit_code,
            0);
  ASSERT_EQ(scene
                .simulate({"-o", "parts", "--contacts", "parts.vtkhdf", "--restart", "state",
                           "--threads", "3"})
                .exit_code,
            0);

  for (const char* name : {"contacts", "contact_passes", "sweeps", "contact_residual",
                           "smallest_distance", "energy/total", "energy/work",
                           "bodies/soft/contact_force", "obstacles/floor/contact_force"}) {
    EXPECT_EQ(scene.series("whole", name), scene.series("parts", name)) << name;
  }
  for (const char* name : {"Points", "NumberOfPoints", "Offsets", "Steps/PointOffsets",
                           "PointData/impulse", "PointData/gap"}) {
    const std::string path = std::string("VTKHDF/") + name;
    EXPECT_EQ(h5_numbers(scene / "whole.vtkhdf", path), h5_numbers(scene / "parts.vtkhdf", path))
        << name;
  }
  EXPECT_EQ(h5_numbers(scene.in("whole", "soft.surface.vtkhdf"), "VTKHDF/PointData/impulse"),
            h5_numbers(scene.in("parts", "soft.surface.vtkhdf"), "VTKHDF/PointData/impulse"));
}

/// A box between the floor and a plane that comes down by more than there is room: no velocity
/// satisfies all contacts, so the steps are marked, the plane stops, and the run goes on.
TEST(SimulateContact, ExitsWith3WhereABodyIsSqueezed) {
  const Landing scene;
  write_text(scene / "scene.json", R"({
    "tetwarp_scene": 1, "time_step": 0.005, "duration": 0.4,
    "bodies": [{"name": "stone", "kind": "rigid", "density": 1000,
      "shape": {"type": "box", "half": [0.05, 0.05, 0.05]}, "pose": {"position": [0, 0, 0.051]}}],
    "obstacles": [{"name": "floor", "plane": {"normal": [0, 0, 1]}},
      {"name": "press", "plane": {"normal": [0, 0, -1], "point": [0, 0, 0.15]},
        "path": [[0, 0, 0, 0], [0.4, 0, 0, -0.1]]}],
    "output": {"every": 20}})");

  const CommandResult result = scene.simulate({"-o", "out"});

  EXPECT_EQ(result.exit_code, 3) << result.err;
  const Numbers converged = scene.series("out", "converged");
  ASSERT_EQ(converged.size(), 81u) << "the run goes on";
  EXPECT_EQ(converged.front(), 1);
  EXPECT_EQ(converged.back(), 0);
  EXPECT_GT(scene.series("out", "clamped_islands").back(), 0);
  EXPECT_GT(scene.series("out", "stalled_scripts").back(), 0);
  const Numbers nearest = scene.series("out", "smallest_distance");
  EXPECT_GT(*std::min_element(nearest.begin(), nearest.end()), 0);
}

TEST(SimulateContact, MarksStepsThatRanOutOfTime) {
  const Landing scene;

  const CommandResult result =
      scene.simulate({"-o", "out", "--steps", "60", "--max-step-seconds", "1e-9"});

  EXPECT_EQ(result.exit_code, 3) << result.err;
  const Numbers late = scene.series("out", "out_of_time");
  EXPECT_EQ(late.front(), 0);
  EXPECT_EQ(late.back(), 1);
  const Numbers nearest = scene.series("out", "smallest_distance");
  EXPECT_GT(*std::min_element(nearest.begin(), nearest.end()), 0);
}

TEST(SimulateContact, RefusesOverlapsUnlessTheyAreUntangled) {
  const Landing scene;
  std::string text = landing_scene;
  text.replace(text.find("[0, 0, 0.052]"), 13, "[0, 0, 0.045]");
  write_text(scene / "scene.json", text);

  const CommandResult refused = scene.simulate({"-o", "out"});

  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_TRUE(refused.has_one_line_error()) << refused.err;
  EXPECT_NE(refused.err.find("'soft'"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("'floor'"), std::string::npos) << refused.err;
  EXPECT_FALSE(fs::exists(scene / "out"));

  const CommandResult result = scene.simulate({"-o", "out", "--untangle"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  const Numbers nearest = scene.series("out", "smallest_distance");
  EXPECT_GT(*std::min_element(nearest.begin(), nearest.end()), 0);
}

TEST(SimulateContact, LeavesAReadableFileOfContactsWhenInterrupted) {
  const Landing scene;
  RunningCommand command(scene, {"simulate", "scene.json", "-o", "out", "--steps", "100000000",
                                 "--contacts", "touch.vtkhdf"});
  for (int tries = 0; tries < 600 && !fs::exists(scene / "touch.vtkhdf"); ++tries) usleep(50'000);
  usleep(1'500'000);

  kill(command.process(), SIGINT);
  EXPECT_EQ(command.wait().exit_code, 130);

  const std::string file = scene / "touch.vtkhdf";
  const Numbers counts = h5_numbers(file, "VTKHDF/NumberOfPoints");
  EXPECT_GT(counts.size(), 1u);
  EXPECT_EQ(h5_numbers(file, "VTKHDF/Steps/Values").size(), counts.size());
  double total = 0;
  for (const double count : counts) total += count;
  EXPECT_EQ(h5_numbers(file, "VTKHDF/Points").size(), 3 * static_cast<std::size_t>(total));
}

TEST(SimulateContact, ErrorsOfItsOptions) {
  const Landing scene;
  const CommandResult no_name = scene.simulate({"-o", "out", "--contacts", "touch.txt"});
  EXPECT_EQ(no_name.exit_code, 2) << no_name.err;
  const CommandResult no_folder =
      scene.simulate({"-o", "out", "--contacts", "scene.json/touch.vtkhdf"});
  EXPECT_EQ(no_folder.exit_code, 1);
  EXPECT_TRUE(no_folder.has_one_line_error()) << no_folder.err;
  const CommandResult of_a_body = scene.simulate({"-o", "out", "--contacts", "out/soft.vtkhdf"});
  EXPECT_EQ(of_a_body.exit_code, 1);
  EXPECT_NE(of_a_body.err.find("'soft'"), std::string::npos) << of_a_body.err;
  EXPECT_EQ(scene.names(), std::vector<std::string>{"scene.json"});
}
/// A block that adheres slides over a floor. Its own material, that of the obstacle, of the pair
/// and of the scene all adhere. @param solver  further keys of the scene
std::string sliding_scene(const std::string& solver, bool adheres) {
  const std::string adhesion = R"("adhesion": {"stiffness": 1e6, "energy": 2, "viscosity": 0.01,
    "bonding_rate": 0.01, "saturation_pressure": 300})";
  const std::string own = adheres ? "\"contact\": {" + adhesion + "}," : "";
  const std::string pair =
      adheres ? R"("pairs": [{"a": "soft", "b": "hill", )" + adhesion + "}]," + adhesion + "," : "";
  return R"({"tetwarp_scene": 1, "time_step": 0.005, "duration": 0.1,)" + solver +
         R"("contact": {)" + pair + R"("friction": 0.3},
    "bodies": [{"name": "soft", "kind": "fem", "shape": {"type": "box", "half": [0.05, 0.05, 0.05]},
      "lattice": {"cells": [2, 2, 2]}, "material": {"E": 1e5, "nu": 0.3, "density": 1000},)" +
         own + R"("pose": {"position": [0, 0, 0.0501]}, "velocity": [0.5, 0.3, 0]}],
    "obstacles": [{"name": "floor",)" +
         own + R"("plane": {"normal": [0, 0, 1]}},
      {"name": "hill", "sphere": {"centre": [0, 0, -1.001], "radius": 1}}]})";
}

TEST(SimulateContact, OptionsStandForLawRuleAndAdhesionOfTheScene) {
  const SimulateScene scene;
  const std::string source = R"("solver": {"law": "pyramid", "rule": "restrictive"},)";
  write_text(scene / "plain.json", sliding_scene("", true));
  write_text(scene / "source.json", sliding_scene(source, true));
  write_text(scene / "free.json", sliding_scene("", false));
  const auto energies = [&](const std::string& file, std::vector<std::string> options) {
    options.insert(options.begin(), {"simulate", file, "--quiet", "-o", "out"});
    const CommandResult result = run_command(scene, options);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return h5_numbers(scene.in("out", "series.h5"), "energy/total");
  };

  const Numbers plain = energies("plain.json", {});
  const Numbers of_source = energies("source.json", {});
  const Numbers free = energies("free.json", {});

  EXPECT_NE(plain, of_source);
  EXPECT_NE(plain, free);
  EXPECT_EQ(energies("plain.json", {"--law", "pyramid", "--rule", "restrictive"}), of_source);
  EXPECT_EQ(energies("source.json", {"--law", "cone", "--rule", "parallel"}), plain);
  EXPECT_EQ(energies("plain.json", {"--no-adhesion"}), free);
}

}  // namespace
}  // namespace tetwarp::test
