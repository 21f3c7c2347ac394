/// @file test_cli_axes.cpp
/// Vectors and tensors of NIfTI files through `tetwarp import`, `warp` and `export`, by hand.
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "tests/support/cli_scene.hpp"
#include "tests/support/nifti_files.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

/// 6 x 6 x 6 unit voxels around the origin.
nifti_1_header centered_header(short intent_code, short components) {
  nifti_1_header header = float_header({6, 6, 6}, components);
  header.intent_code = intent_code;
  header.sform_code = NIFTI_XFORM_TALAIRACH;
  header.srow_x[0] = header.srow_y[1] = header.srow_z[2] = 1;
  header.srow_x[3] = header.srow_y[3] = header.srow_z[3] = -2.5F;
  std::strcpy(header.descrip, "by hand");
  return header;
}

/// A box around the image that turns by 90 degrees: `first` goes to `second`.
void write_turn(const std::string& path, std::size_t first, std::size_t second) {
  Mesh mesh = box_mesh();
  std::vector<Point3> displacement;
  for (std::size_t node = 0; node < 8; ++node) {
    Point3& x = mesh.rest_positions[node];
    x = {(node & 1) != 0 ? 4.0 : -4.0, (node & 2) != 0 ? 4.0 : -4.0, (node & 4) != 0 ? 4.0 : -4.0};
    Point3 turned = x;
    turned[first] = -x[second];
    turned[second] = x[first];
    displacement.push_back({turned[0] - x[0], turned[1] - x[1], turned[2] - x[2]});
  }
  write_mesh(path, mesh, {displacement}, {1});
}

/// The components of a voxel in the middle after import, warp and export.
std::vector<float> warped(const TemporaryFolder& folder, const Names& import, const Names& warp) {
  Names first{"import", "in.nii", "-o", "in.vtkhdf"};
  first.insert(first.end(), import.begin(), import.end());
  Names second{"warp", "in.vtkhdf", "mesh.vtkhdf", "-o", "out.vtkhdf"};
  second.insert(second.end(), warp.begin(), warp.end());
  const Names third{"export", "out.vtkhdf", "--array", "values", "-o", "out.nii"};
  for (const Names& command : {first, second, third}) {
    const CommandResult result = run_command(folder, command);
    EXPECT_EQ(result.exit_code, 0) << command.front() << ": " << result.err;
  }
  return components_in(folder / "out.nii", 2 + 6 * (2 + 6 * 2));
}

void expect_near(const std::vector<float>& found, const std::vector<float>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t c = 0; c < found.size(); ++c) EXPECT_NEAR(found[c], expected[c], 1e-6) << c;
}

/// diag(3, 2, 1) about z becomes diag(2, 3, 1): xx xy yy xz yz zz in the file.
TEST(CliAxes, ASymmetricMatrixTurnsInNiftisOrder) {
  const TemporaryFolder folder;
  write_constant(folder / "in.nii", centered_header(NIFTI_INTENT_SYMMATRIX, 6), {3, 0, 2, 0, 0, 1});
  write_turn(folder / "mesh.vtkhdf", 0, 1);

  expect_near(warped(folder, {}, {"--tensors", "values", "--outputs", "strain"}),
              {2, 0, 3, 0, 0, 1});

  const nifti_1_header header = header_in(folder / "out.nii");
  EXPECT_EQ(header.intent_code, NIFTI_INTENT_SYMMATRIX);
  EXPECT_EQ(header.sform_code, NIFTI_XFORM_TALAIRACH);
  EXPECT_EQ(header.qform_code, 0);
  EXPECT_STREQ(header.descrip, "by hand");
  const Names strain{"export", "out.vtkhdf", "--array", "tetwarp_strain", "-o", "strain.nii"};
  EXPECT_EQ(run_command(folder, strain).exit_code, 0);
  EXPECT_EQ(header_in(folder / "strain.nii").intent_code, NIFTI_INTENT_SYMMATRIX);
  EXPECT_EQ(header_in(folder / "strain.nii").sform_code, NIFTI_XFORM_TALAIRACH);
  EXPECT_STREQ(header_in(folder / "strain.nii").descrip, "");
}

/// A turn about x in RAS takes y to z. A file of ITK holds LPS: its (0, 1, 0) is -y in RAS, turns
/// to -z, and is written as ITK reads it.
TEST(CliAxes, VectorsOfItkTurnInTheirOwnAxes) {
  const TemporaryFolder folder;
  write_constant(folder / "in.nii", centered_header(NIFTI_INTENT_VECTOR, 3), {0, 1, 0});
  write_turn(folder / "mesh.vtkhdf", 1, 2);

  expect_near(warped(folder, {}, {"--vectors", "values"}), {0, 0, 1});
  expect_near(warped(folder, {"--axes", "lps"}, {"--vectors", "values"}), {0, 0, -1});

  write_constant(folder / "in.nii", centered_header(NIFTI_INTENT_VECTOR, 3), {1, 2, 3});
  expect_near(warped(folder, {"--axes", "lps"}, {}), {1, 2, 3});
  const Names as_ras{"export", "out.vtkhdf", "--axes", "ras", "-o", "ras.nii"};
  EXPECT_EQ(run_command(folder, as_ras).exit_code, 0);
  expect_near(components_in(folder / "ras.nii", 0), {-1, -2, 3});
}

/// Axes are only in the header's facts: a copy with other facts is not kept by --resume.
TEST(CliAxes, ResumeWritesAFileWithOtherFactsAgain) {
  const TemporaryFolder folder;
  nifti_1_header header = centered_header(NIFTI_INTENT_NONE, 1);
  write_constant(folder / "in.nii", header, {5});
  write_turn(folder / "mesh.vtkhdf", 0, 1);
  warped(folder, {}, {"--resume"});
  std::strcpy(header.descrip, "another text");
  write_constant(folder / "in.nii", header, {5});

  warped(folder, {}, {"--resume"});

  EXPECT_STREQ(header_in(folder / "out.nii").descrip, "another text");
}

TEST(CliAxes, ADisplacementInRasGetsTheIntentThatItkTurns) {
  const Scene scene;
  ASSERT_EQ(scene.warp({"-o", "out.vtkhdf", "--steps", "3", "--outputs", "displacement"}).exit_code,
            0);
  Names words{"export", "out.vtkhdf", "--array", "tetwarp_displacement", "-o", "field.nii"};
  EXPECT_EQ(run_command(scene, words).exit_code, 0);
  EXPECT_EQ(header_in(scene / "field.nii").intent_code, NIFTI_INTENT_VECTOR);
  words.insert(words.end(), {"--axes", "ras"});
  EXPECT_EQ(run_command(scene, words).exit_code, 0);
  EXPECT_EQ(header_in(scene / "field.nii").intent_code, NIFTI_INTENT_DISPVECT);
}
}  // namespace
}  // namespace tetwarp::test
