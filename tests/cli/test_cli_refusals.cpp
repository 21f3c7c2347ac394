/// @file test_cli_refusals.cpp
/// What is refused before anything is written, and what no command passes over in silence.
#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "tests/support/cli_scene.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

Names joined(Names words, const Names& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// A scene with an image, a transform of ITK, and a mesh of the shift by one voxel in two files.
class CliRefusals : public testing::Test {
 protected:
  CliRefusals() {
    write_nifti(scene / "image.nii", ramp_volume<float>());
    write_text(scene / "shift.tfm",
               "#Insight Transform File V1.0\n#Transform 0\nTransform: "
               "TranslationTransform_double_3_3\nParameters: 2 0 0\nFixedParameters: \n");
    Mesh moved = box_mesh();
    for (Point3& node : moved.rest_positions) node[0] += 2;
    write_mesh(scene / "one.vtkhdf", box_mesh(), shifts({1}));
    write_mesh(scene / "rest.vtkhdf", box_mesh());
    write_mesh(scene / "moved.vtkhdf", moved);
  }

  CommandResult run(const Names& words) const { return run_command(scene, words); }

  Scene scene;
};

/// For every format of an output and every kind of array: --dry-run fails exactly where the warp
/// fails, with the same line, and then nothing is written, by a mesh and by a transform.
TEST_F(CliRefusals, OfWhatAFormatCannotHoldComeBeforeAnythingIsWritten) {
  const Volume doubles = ramp_volume<double>();
  Volume vectors = make_volume(doubles.grid, PixelType::float32, 3, "vectors");
  write_volumes(scene / "doubles.vtkhdf", {&doubles});
  write_volumes(scene / "vectors.vtkhdf", {&vectors});
  BlockVolumeWriter dotted(scene / "dotted.vti", doubles.grid, {{"a.b", PixelType::float64}}, {},
                           false);
  dotted.write(0, {{0, 0, 0}, doubles.grid.dims}, doubles.data.data());
  dotted.finish();
  int refused = 0, taken = 0;
  for (const std::string extension : {".mgz", ".vti", ".nii", ".mha", ".vtkhdf"}) {
    for (const Names& inputs : {Names{"image.nii", "mesh.vtkhdf"},
                                {"image.nii", "shift.tfm"},
                                {"doubles.vtkhdf", "one.vtkhdf"},
                                {"doubles.vtkhdf", "shift.tfm"},
                                {"vectors.vtkhdf", "one.vtkhdf"},
                                {"dotted.vti", "one.vtkhdf"}}) {
      const bool is_dotted = inputs[0] == "dotted.vti";
      if (is_dotted && extension != ".vtkhdf") continue;  // reading it takes a program of its own
      for (const Names& options : {Names{}, {"--outputs", "displacement"}, {"--temporal"}}) {
        if ((is_dotted || inputs[1] == "shift.tfm") && !options.empty()) continue;
        const Names words =
            joined(joined({"warp"}, inputs), joined(options, {"-o", "out/warped" + extension}));
        const Names before = scene.names();
        const CommandResult planned = run(joined(words, {"--dry-run"}));
        EXPECT_EQ(scene.names(), before);
        const CommandResult result = run(words);

        EXPECT_EQ(planned.exit_code, result.exit_code) << planned.err << result.err;
        if (result.exit_code == 0) {
          ++taken;
          fs::remove_all(scene / "out");
          continue;
        }
        ++refused;
        EXPECT_TRUE(result.has_one_line_error()) << result.err;
        EXPECT_EQ(planned.err, result.err);
        EXPECT_EQ(scene.names(), before);
      }
    }
  }
  EXPECT_EQ(refused, 12);  // .mgz 8, .vti 3, the name with a dot
  EXPECT_EQ(taken, 44);
}

/// Of several volumes no earlier one is written.
TEST_F(CliRefusals, OfOneOfSeveralVolumesStopThemAll) {
  write_nifti(scene / "a.nii", ramp_volume<float>());
  fs::create_directory(scene / "in");
  EXPECT_EQ(run({"export", "volume.vtkhdf", "-o", "in/b.mgz"}).exit_code, 0);

  const CommandResult result = run(
      {"warp", "a.nii", "in/b.mgz", "one.vtkhdf", "-o", "out", "--outputs", "mask,displacement"});

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.err,
            "tetwarp: out/b_displacement.mgz: holds one number per voxel; write .nii.gz, .nrrd or "
            ".mha\n");
  EXPECT_FALSE(fs::exists(scene / "out"));
  const CommandResult field =
      run({"compose", "mesh.vtkhdf", "-o", "field.mgz", "--like", "volume.vtkhdf"});
  EXPECT_EQ(field.exit_code, 1);
  EXPECT_NE(field.err.find("field_0000.mgz: holds one number per voxel"), std::string::npos)
      << field.err;
}

/// Every command that uses a mesh whose deformation is not found prints the same warning.
TEST_F(CliRefusals, OfNoCommandHideAMeshThatIsNotDeformed) {
  write_text(scene / "points.csv", "x,y,z\n10,2,105\n");
  const std::string told = run({"warp", "volume.vtkhdf", "rest.vtkhdf", "-o", "w.vtkhdf"}).err;
  EXPECT_TRUE(told.starts_with("tetwarp: warning: rest.vtkhdf: the mesh has no point array"))
      << told;
  for (const Names& words :
       {Names{"compose", "rest.vtkhdf", "-o", "f.nii", "--like", "image.nii"},
        {"compose", "shift.tfm", "rest.vtkhdf^-1", "-o", "f.nii", "--like", "image.nii"},
        {"invert", "rest.vtkhdf", "-o", "i.vtkhdf"},
        {"points", "points.csv", "rest.vtkhdf", "-o", "p.csv"}}) {
    EXPECT_TRUE(run(words).err.starts_with(told)) << words.front();
  }
  for (const Names& words : {Names{"compose", "one.vtkhdf", "-o", "f.nii", "--like", "image.nii"},
                             {"invert", "one.vtkhdf", "-o", "i.vtkhdf"},
                             {"points", "points.csv", "one.vtkhdf", "-o", "p.csv"}}) {
    EXPECT_EQ(run(words).err.find("warning"), std::string::npos) << words.front();
  }
}

/// --rest is of meshes without a displacement of their own: the field is that of the displacement.
TEST_F(CliRefusals, OfComposeAreNoneForAMeshOfRestPositions) {
  const auto field = [&](const Names& links) {
    const CommandResult result =
        run(joined(joined({"compose"}, links), {"-o", "f.nii", "--like", "image.nii"}));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err.find("nothing is deformed"), std::string::npos) << result.err;
    return text_of(scene / "f.nii");
  };

  EXPECT_EQ(field({"moved.vtkhdf", "--rest", "rest.vtkhdf"}), field({"one.vtkhdf"}));
  EXPECT_EQ(field({"one.vtkhdf^-1", "moved.vtkhdf", "--rest", "rest.vtkhdf"}),
            field({"one.vtkhdf^-1", "one.vtkhdf"}));
}

/// --displacement is of meshes of other programs, beside which VTKHDF meshes keep theirs.
TEST_F(CliRefusals, OfComposeAreNoneForAnArrayOfAnotherName) {
  const Mesh mesh = box_mesh();
  std::string text =
      "# vtk DataFile Version 3.0\nbox\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n";
  for (const Point3& p : mesh.rest_positions) {
    for (const double x : p) text += std::to_string(x) + " ";
  }
  text += "\nCELLS 5 25\n";
  for (const auto& tet : mesh.tets) {
    text += "4";
    for (const auto node : tet) text += " " + std::to_string(node);
    text += "\n";
  }
  text += "CELL_TYPES 5\n10 10 10 10 10\nPOINT_DATA 8\nVECTORS u double\n";
  for (int node = 0; node < 8; ++node) text += "2 0 0\n";
  write_text(scene / "box.vtk", text);
  const Names end{"-o", "f.nii", "--like", "image.nii"};
  const CommandResult told = run(joined({"compose", "box.vtk"}, end));
  if (told.err.find("this build cannot read") != std::string::npos) GTEST_SKIP() << told.err;
  EXPECT_NE(told.err.find("nothing is deformed; --displacement names another point array"),
            std::string::npos)
      << told.err;

  const auto field = [&](const Names& words) {
    const CommandResult result = run(joined(joined({"compose"}, words), end));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err.find("nothing is deformed"), std::string::npos) << result.err;
    return text_of(scene / "f.nii");
  };
  EXPECT_EQ(field({"box.vtk", "--displacement", "u"}), field({"one.vtkhdf"}));
  EXPECT_EQ(field({"box.vtk", "one.vtkhdf", "--displacement", "u"}),
            field({"one.vtkhdf", "one.vtkhdf"}));
  const CommandResult import =
      run({"import", "box.vtk", "-o", "box.vtkhdf", "--displacement", "u", "--compress", "3"});
  EXPECT_EQ(import.err, "tetwarp: box.vtk: is a mesh; leave out --compress, which is for images\n");
  EXPECT_NE(run({"import", "box.vtk", "-o", "box.vtkhdf", "--series", "1.2"}).err.find("--series"),
            std::string::npos);
}

/// invert names the arrays that it leaves out, as deform does.
TEST_F(CliRefusals, OfArraysByInvertAreNamed) {
  const MeshArray heat{.name = "heat", .data = std::vector<std::byte>(8 * sizeof(double))};
  write_mesh(scene / "warm.vtkhdf", box_mesh(), shifts({1}), {0}, {heat});

  const CommandResult inverse = run({"invert", "warm.vtkhdf", "-o", "i.vtkhdf"});
  const CommandResult deformed = run({"deform", "warm.vtkhdf", "-o", "d.vtkhdf", "--steps", "1"});

  EXPECT_EQ(inverse.exit_code, 0);
  EXPECT_TRUE(inverse.err.starts_with("tetwarp: warm.vtkhdf: left out: ")) << inverse.err;
  EXPECT_NE(inverse.err.find("heat"), std::string::npos) << inverse.err;
  const std::string own = "its own displacement, ";
  ASSERT_NE(deformed.err.find(own), std::string::npos) << deformed.err;
  EXPECT_EQ(std::string(deformed.err).erase(deformed.err.find(own), own.size()), inverse.err);
}

/// An option without an effect is an error that names it, and nothing is written.
TEST_F(CliRefusals, OfOptionsWithoutAnEffectNameThem) {
  const Names warp{"warp", "image.nii", "shift.tfm", "-o", "out.nii"};
  const Names compose{"compose", "shift.tfm", "-o", "out.nii", "--like", "image.nii"};
  const Names deform{"deform", "one.vtkhdf", "-o", "out.vtkhdf"};
  const Names by_mesh{"warp", "image.nii", "one.vtkhdf", "-o"};
  write_text(scene / "axes.csv", "volume,transform,output\nimage.nii,shift.tfm,out.nii\n");
  struct Case {
    Names words;
    std::string option;
  };
  for (const auto& [words, option] :
       {Case{joined(warp, {"--axes", "ras"}), "--axes"},
        {joined(warp, {"--axes", "lps"}), "--axes"},
        {{"warp", "--batch", "axes.csv", "--axes", "ras"}, "--axes"},
        {joined(compose, {"--axes", "lps"}), "--axes"},
        {joined(compose, {"--ten-nodes", "split"}), "--ten-nodes"},
        {joined(compose, {"--steps", "0"}), "--steps"},
        {joined(compose, {"--rest", "rest.vtkhdf"}), "--rest"},
        {joined(compose, {"--rest-step", "0"}), "--rest-step"},
        {joined(compose, {"--displacement", "u"}), "--displacement"},
        {{"compose", "one.vtkhdf", "-o", "out.nii", "--like", "image.nii", "--rest", "rest.vtkhdf"},
         "--rest"},
        {{"compose", "one.vtkhdf", "-o", "out.nii", "--like", "image.nii", "--axes", "lps"},
         "--axes"},
        {{"compose", "one.vtkhdf", "-o", "out.vti", "--like", "image.nii", "--compress", "4"},
         "--compress"},
        {joined(deform, {"--kind", "twist", "--offset", "1,2,3"}), "--offset"},
        {joined(deform, {"--seed", "7"}), "--seed"},
        {joined(deform, {"--kind", "translate", "--amount", "2"}), "--amount"},
        {joined(deform, {"--kind", "random", "--axis", "x"}), "--axis"},
        {joined(by_mesh, {"out.mgh", "--compress", "3"}), "--compress"},
        {joined(by_mesh, {"out.vti", "--compress", "3"}), "--compress"},
        {joined(by_mesh, {"out.nii", "--backend", "cpu", "--device", "1"}), "--device"},
        {joined(by_mesh, {"out.nii", "--like-series", "1.2"}), "--like-series"},
        {joined(by_mesh, {"out.nii", "--count-folded"}), "--count-folded"},
        {{"simulate", "--scene", "torso", "-o", "out", "--filter", "cubic"}, "--filter"},
        {{"simulate", "--scene", "torso", "-o", "out", "--spacing", "1,1,1"}, "--spacing"},
        {{"simulate", "--scene", "torso", "-o", "out", "--picture", "--cast", "--compress", "3"},
         "--compress"},
        {{"view", "torso", "--backend", "cpu", "--device", "1"}, "--device"},
        {{"mesh", "--from-surface", "one.vtkhdf", "-o", "out.vtkhdf", "--step", "0"}, "--step"},
        {{"mesh", "--from-surface", "one.vtkhdf", "-o", "out.vtkhdf", "--array", "u"},
         "--array"}}) {
    const Names before = scene.names();
    const CommandResult result = run(words);

    EXPECT_NE(result.exit_code, 0) << option;
    EXPECT_TRUE(result.has_one_line_error()) << result.err;
    EXPECT_NE(result.err.find(option), std::string::npos) << result.err;
    EXPECT_EQ(scene.names(), before) << option;
  }
}

/// The error of a step that does not exist names the file.
TEST_F(CliRefusals, OfStepsNameTheFile) {
  for (const Names& words :
       {Names{"warp", "image.nii", "mesh.vtkhdf", "-o", "out.nii"},
        {"compose", "one.vtkhdf", "mesh.vtkhdf^-1", "-o", "out.nii", "--like", "image.nii"},
        {"certify", "mesh.vtkhdf"}}) {
    const CommandResult result = run(joined(words, {"--steps", "7"}));

    EXPECT_EQ(result.exit_code, 1);
    EXPECT_TRUE(result.err.starts_with("tetwarp: mesh.vtkhdf: ")) << result.err;
  }
}

/// The output of a header of NRRD in a folder is one file.
TEST_F(CliRefusals, OfSeveralVolumesAreNoneForPairs) {
  EXPECT_EQ(run({"export", "volume.vtkhdf", "-o", "a.nrrd"}).exit_code, 0);
  const std::string whole = text_of(scene / "a.nrrd");
  const std::size_t end = whole.find("\n\n") + 1;
  write_text(scene / "b.nhdr", whole.substr(0, end) + "data file: b.raw\n");
  write_text(scene / "b.raw", whole.substr(end + 1));

  const CommandResult result = run({"warp", "b.nhdr", "image.nii", "one.vtkhdf", "-o", "out"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(fs::exists(scene / "out/b.nrrd"));
  fs::copy(scene / "image.nii", scene / "scan");
  const CommandResult refused = run({"warp", "scan", "image.nii", "one.vtkhdf", "-o", "other"});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_TRUE(refused.err.starts_with("tetwarp: scan: ")) << refused.err;
  EXPECT_NE(refused.err.find("rename it, or warp it alone"), std::string::npos) << refused.err;
}
}  // namespace
}  // namespace tetwarp::test
