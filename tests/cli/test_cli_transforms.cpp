/// @file test_cli_transforms.cpp
/// `tetwarp warp` by fields, `compose` and `invert`: each agrees with the warp by the mesh. Formats
/// and conventions: tests/io/check_transforms.py.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <tetwarp/io.hpp>
#include <vector>

#include "tests/support/cli_scene.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

class CliTransforms : public ::testing::Test {
 protected:
  CommandResult run(const Names& words, int exit_code = 0) const {
    CommandResult result = run_command(scene, words);
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_TRUE(exit_code == 0 || result.has_one_line_error()) << result.err;
    return result;
  }
  double difference(const std::string& a, const std::string& b) const {
    const Volume first = read_volume(scene / a), second = read_volume(scene / b);
    EXPECT_EQ(first.data.size(), second.data.size());
    const auto x = first.samples<float>(), y = second.samples<float>();
    double largest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      largest = std::max(largest, static_cast<double>(std::abs(x[i] - y[i])));
    }
    return largest;
  }

  const Scene scene;
};

/// The ramp has 960 as its largest sample; the mesh covers every voxel center.
TEST_F(CliTransforms, AFieldOfTheWarpWarpsAsTheMesh) {
  run({"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "mesh.nii.gz", "--steps", "3", "--outputs",
       "displacement"});
  run({"warp", "volume.vtkhdf", "mesh_displacement.nii.gz", "-o", "field.nii.gz", "--outside",
       "background"});
  EXPECT_LT(difference("field.nii.gz", "mesh.nii.gz"), 960.0);
  run({"compose", "mesh.vtkhdf", "-o", "composed.vtkhdf", "--like", "volume.vtkhdf", "--steps",
       "3"});
  run({"warp", "volume.vtkhdf", "composed.vtkhdf", "-o", "by_field.vtkhdf"});
  run({"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "by_mesh.vtkhdf", "--steps", "3", "--outside",
       "identity"});
  EXPECT_LT(difference("by_field.vtkhdf", "by_mesh.vtkhdf"), 1e-3);
}

TEST_F(CliTransforms, ComposedOfAMeshAndItsInverseIsTheIdentity) {
  run({"deform", "mesh.vtkhdf", "-o", "bent.vtkhdf", "--kind", "bend", "--amount", "0.2", "--steps",
       "1"});
  const CommandResult inverse = run({"invert", "bent.vtkhdf", "-o", "back.vtkhdf"});
  EXPECT_NE(inverse.out.find("round trip of 13 points within"), std::string::npos) << inverse.out;
  EXPECT_EQ(inverse.err, "");
  // Where the bent mesh is; elsewhere it moves nothing, and its inverse does.
  run({"warp", "volume.vtkhdf", "bent.vtkhdf", "-o", "bent_volume.vtkhdf", "--outputs", "mask"});
  const Volume mask = read_volume(scene / "bent_volume.vtkhdf", "tetwarp_mask");
  const auto covered = mask.samples<std::uint8_t>();
  EXPECT_GT(std::count(covered.begin(), covered.end(), 1), 600);
  for (const std::string& inverse : Names{"bent.vtkhdf^-1", "back.vtkhdf"}) {
    run({"compose", inverse, "bent.vtkhdf", "-o", "none.vtkhdf", "--like", "volume.vtkhdf"});
    const Volume field = read_volume(scene / "none.vtkhdf", "tetwarp_displacement");
    const auto u = field.samples<float>();
    for (std::size_t n = 0; n < u.size(); ++n) {
      if (covered[n / 3] == 0) continue;
      EXPECT_LT(std::abs(u[n]), 1e-5) << inverse << n;
    }
  }
}

TEST_F(CliTransforms, InvertTellsFoldsAndRefusesSeveralSteps) {
  Mesh mesh = box_mesh();
  std::vector<Point3> moved(mesh.rest_positions.size(), Point3{0, 0, 0});
  moved[0] = {60, 40, 40};  // through the opposite face
  write_mesh(scene / "folded.vtkhdf", mesh, {moved}, {0});

  const CommandResult folded = run({"invert", "folded.vtkhdf", "-o", "back.vtkhdf"});

  EXPECT_NE(folded.err.find("folds: "), std::string::npos) << folded.err;
  EXPECT_EQ(std::count(folded.err.begin(), folded.err.end(), '\n'), 1);
  EXPECT_NE(
      run({"invert", "mesh.vtkhdf", "-o", "back.vtkhdf"}, 1).err.find("choose one with --step"),
      std::string::npos);
}

TEST_F(CliTransforms, OptionsOfMeshesAndBadFilesAreRefused) {
  run({"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "w.nii.gz", "--steps", "3", "--outputs",
       "displacement"});
  const std::string field = "w_displacement.nii.gz";
  EXPECT_NE(run({"warp", "volume.vtkhdf", field, "-o", "o.vtkhdf", "--count-folded"}, 1)
                .err.find("--count-folded is for warps by a mesh"),
            std::string::npos);
  EXPECT_NE(run({"warp", "volume.vtkhdf", "volume.vtkhdf", field, "-o", "o"}, 1)
                .err.find("one image at a time"),
            std::string::npos);
  EXPECT_NE(run({"warp", "volume.vtkhdf", field, "-o", "o.vtkhdf", "--grid", "bounds"}, 1)
                .err.find("--grid bounds is for warps by a mesh"),
            std::string::npos);
  EXPECT_NE(run({"compose", "volume.vtkhdf", "-o", "o.vtkhdf", "--like", "volume.vtkhdf"}, 1)
                .err.find("expected a mesh"),
            std::string::npos);
  write_text(
      scene / "flat.tfm",
      "#Insight Transform File V1.0\nTransform: ScaleTransform_double_3_3\nParameters: 1 0 1\n"
      "FixedParameters: 0 0 0\n");
  EXPECT_NE(run({"compose", "flat.tfm^-1", "-o", "o.vtkhdf", "--like", "volume.vtkhdf"}, 1)
                .err.find("has no inverse"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(scene / "o.vtkhdf"));
}

TEST_F(CliTransforms, NumbersThatAreNotFiniteAreRefused) {
  const auto refusal = [&](const std::string& file) {
    const std::string text =
        run({"warp", "volume.vtkhdf", file, "-o", "o.vtkhdf", "--outside", "identity"}, 1).err;
    EXPECT_FALSE(fs::exists(scene / "o.vtkhdf"));
    return text;
  };
  const std::string head = "#Insight Transform File V1.0\nTransform: AffineTransform_double_3_3\n";
  write_text(scene / "a.tfm",
             head + "Parameters: 1 0 0 0 1 0 0 nan 1 0 0 0\nFixedParameters: 0 0 0\n");
  write_text(scene / "b.tfm",
             head + "Parameters: 1 0 0 0 1 0 0 0 1 0 0 0\nFixedParameters: 0 inf 0\n");
  Volume field =
      make_volume(ramp_volume<float>().grid, PixelType::float32, 3, "tetwarp_displacement");
  field.samples<float>()[3 * (12 * (10 * 5 + 4) + 2) + 1] = std::numeric_limits<float>::quiet_NaN();
  write_volumes(scene / "field.vtkhdf", {&field});

  EXPECT_NE(refusal("a.tfm").find("a.tfm: Transform 0: Parameters[7]: is not a number"),
            std::string::npos);
  EXPECT_NE(refusal("b.tfm").find("b.tfm: Transform 0: FixedParameters[1]: is infinite"),
            std::string::npos);
  write_text(scene / "c.tfm", head + "Parameters: 1 0 0 0 1 0 0 0 1 0 0 0\nFixedParameters: 5 7\n");
  EXPECT_NE(refusal("c.tfm").find("expected 3 fixed parameters, got 2"), std::string::npos);
  EXPECT_NE(refusal("field.vtkhdf").find("its displacement is not finite at voxel (2, 4, 5)"),
            std::string::npos);
}

TEST_F(CliTransforms, ReportsAndProvenanceReplaceNoOtherFile) {
  run({"compose", "mesh.vtkhdf", "-o", "field.vtkhdf", "--like", "volume.vtkhdf", "--steps", "3"});
  const Names before = scene.names();
  const std::string volume = text_of(scene / "volume.vtkhdf");
  const auto refused = [&](const Names& more, const std::string& line) {
    Names words{"warp", "volume.vtkhdf", "field.vtkhdf", "-o", "o.vtkhdf"};
    words.insert(words.end(), more.begin(), more.end());
    const CommandResult result = run(words, 1);
    EXPECT_NE(result.err.find(line), std::string::npos) << result.err;
  };

  refused({"--report", "volume.vtkhdf"}, "volume.vtkhdf: is also an input");
  refused({"--report", "o.vtkhdf"}, "o.vtkhdf: would be written twice");
  refused({"--report", "o.vtkhdf.json", "--provenance"}, "o.vtkhdf.json: would be written twice");

  EXPECT_EQ(scene.names(), before);
  EXPECT_EQ(text_of(scene / "volume.vtkhdf"), volume);
}

/// What is left out is printed and in the report; with --quiet it is in the report only.
TEST_F(CliTransforms, ReportWhatTheyLeaveOut) {
  run({"compose", "mesh.vtkhdf", "-o", "field.vtkhdf", "--like", "volume.vtkhdf", "--steps", "3"});
  Volume volume = ramp_volume<float>();
  const auto samples = volume.samples<float>();
  std::string text =
      "NRRD0004\ntype: float\ndimension: 3\nsizes: 12 10 8\n"
      "space: right-anterior-superior\nspace origin: (5,-3,100)\n"
      "space directions: (2,0,0) (0,2,0) (0,0,2)\nencoding: raw\nendian: little\n"
      "Patient:=no one\n\n";
  text.append(reinterpret_cast<const char*>(samples.data()), 4 * samples.size());
  write_text(scene / "volume.nrrd", text);
  const Names words{"warp", "volume.nrrd", "field.vtkhdf", "-o", "o.vtkhdf", "--report", "r.json"};
  Names quiet = words;
  quiet.emplace_back("--quiet");

  const std::string told = run(words).err;
  const std::string line = "volume.nrrd: left out: ";
  EXPECT_NE(told.find(line), std::string::npos) << told;
  EXPECT_EQ(run(quiet).err, "");
  EXPECT_NE(text_of(scene / "r.json").find(line), std::string::npos);
}

TEST_F(CliTransforms, RunWithoutMpirun) {
  run({"compose", "mesh.vtkhdf", "-o", "field.vtkhdf", "--like", "volume.vtkhdf", "--steps", "3"});
  const CommandResult result =
      run_command(scene, {"warp", "volume.vtkhdf", "field.vtkhdf", "-o", "o.vtkhdf"},
                  {.launcher = {"/usr/bin/env", "OMPI_COMM_WORLD_SIZE=2"}});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(result.has_one_line_error()) << result.err;
  EXPECT_NE(result.err.find("runs without mpirun"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(scene / "o.vtkhdf"));
}

/// The mesh covers every voxel center; cut in half, it moves all of them as its nearest points.
TEST_F(CliTransforms, VoxelsOutsideMoveWithTheNearestPoint) {
  const Mesh whole = box_mesh();
  Mesh part = whole;
  part.tets.resize(1);
  const std::vector<Point3> shift(whole.rest_positions.size(), Point3{1.5, -2, 0.5});
  write_mesh(scene / "whole.vtkhdf", whole, {shift}, {0});
  write_mesh(scene / "part.vtkhdf", part, {shift}, {0});

  run({"warp", "volume.vtkhdf", "whole.vtkhdf", "-o", "whole.nii.gz", "--outside", "nearest"});
  run({"warp", "volume.vtkhdf", "part.vtkhdf", "-o", "part.nii.gz", "--outside", "nearest"});
  run({"warp", "volume.vtkhdf", "part.vtkhdf", "-o", "far.nii.gz", "--outside", "falloff:1e6"});

  EXPECT_LT(difference("whole.nii.gz", "part.nii.gz"), 1e-2);
  EXPECT_LT(difference("whole.nii.gz", "far.nii.gz"), 1e-2);
}

}  // namespace
}  // namespace tetwarp::test
