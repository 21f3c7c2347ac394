/// @file test_cli_fields.cpp
/// Arrays of the deformation beside the warped ones, and their export.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/support/cli_scene.hpp"
#include "tests/support/nifti_files.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

TEST(CliFields, WritesMaskAndOwnerBesideTheArray) {
  const Scene scene;

  const CommandResult result =
      scene.warp({"-o", "out.vtkhdf", "--steps", "3", "--outputs", "mask,tet"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  const Volume mask = read_volume(scene / "out.vtkhdf", "tetwarp_mask");
  const Volume tet = read_volume(scene / "out.vtkhdf", "tetwarp_tet");
  EXPECT_EQ(mask.type, PixelType::uint8);
  EXPECT_EQ(tet.type, PixelType::int32);
  for (std::size_t v = 0; v < 960; ++v) {
    const bool is_covered = v % 12 >= 3;
    EXPECT_EQ(mask.samples<std::uint8_t>()[v], is_covered ? 1 : 0);
    EXPECT_EQ(tet.samples<std::int32_t>()[v] >= 0, is_covered);
  }
}

/// The box moves by 3 voxels of 2 along x; at rest it covers all voxels.
TEST(CliFields, WritesFieldsOfTheDeformationAndExportsDisplacementsForItk) {
  const Scene scene;

  const CommandResult result = scene.warp({"-o", "out.vtkhdf", "--steps", "3", "--outputs",
                                           "displacement,jacobian,gradient,strain,forward"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto expect_field = [&](const std::string& name, const std::vector<float>& inside,
                                bool covers_all) {
    const Volume field = read_volume(scene / "out.vtkhdf", "tetwarp_" + name);
    ASSERT_EQ(field.components, std::ssize(inside)) << name;
    const auto samples = field.samples<float>();
    for (std::size_t s = 0; s < samples.size(); ++s) {
      const bool is_covered = covers_all || s / inside.size() % 12 >= 3;
      ASSERT_EQ(samples[s], is_covered ? inside[s % inside.size()] : 0) << name << ' ' << s;
    }
  };
  expect_field("displacement", {-6, 0, 0}, false);
  expect_field("jacobian", {1}, false);
  expect_field("gradient", {1, 0, 0, 0, 1, 0, 0, 0, 1}, false);
  expect_field("strain", {0, 0, 0, 0, 0, 0}, false);
  expect_field("forward", {6, 0, 0}, true);
  for (const auto& [axes, x] : {std::pair<Names, float>{{}, 6}, {{"--axes", "ras"}, -6}}) {
    Names words{"export", "out.vtkhdf", "--array", "tetwarp_displacement", "-o", "field.nii"};
    words.insert(words.end(), axes.begin(), axes.end());
    EXPECT_EQ(run_command(scene, words).exit_code, 0);
    EXPECT_EQ(read_nifti(scene / "field.nii").samples<float>()[3 * 5], x);
  }
}

/// ITK's world: millimeters, turned from RAS to LPS, but as it is where the header has no form; an
/// image of one slice is 2D. The box moves by (6, 0, 0) units of the header.
TEST(CliFields, OfNiftiImagesAreInTheWorldThatItkGivesThem) {
  const struct {
    int units;
    bool has_form, is_slice;
    std::vector<float> displacement;
  } cases[] = {{2, true, false, {6, 0, 0}},       {3, true, false, {6e-3F, 0, 0}},
               {1, true, false, {6e3F, 0, 0}},    {0, true, false, {6, 0, 0}},
               {3, false, false, {-6e-3F, 0, 0}}, {2, true, true, {6, 0}},
               {1, false, true, {-6e3F, 0}}};
  for (const auto& expected : cases) {
    const Scene scene;
    Volume volume = ramp_volume<float>("values");
    if (expected.is_slice) volume.grid.dims[2] = 1;
    volume.grid.origin = {0, 0, 0};
    volume.data.resize(volume.byte_count());
    NiftiFacts facts;
    facts.xyzt_units = expected.units;
    facts.sform_code = facts.qform_code = expected.has_form ? 1 : 0;
    write_nifti(scene / "image.nii", volume, Axes::ras, facts);
    Mesh mesh = box_mesh();
    for (Point3& x : mesh.rest_positions) x = {x[0] - 5, x[1] + 3, x[2] - 100};
    write_mesh(scene / "mesh.vtkhdf", mesh, shifts({3}));

    const CommandResult result = run_command(
        scene, {"warp", "image.nii", "mesh.vtkhdf", "-o", "out.nii", "--outputs", "displacement"});

    EXPECT_EQ(result.exit_code, 0) << result.err;
    const std::string told = "has the two components in the slice";
    EXPECT_EQ(result.err.find(told) != std::string::npos, expected.is_slice) << result.err;
    EXPECT_EQ(header_in(scene / "out_displacement.nii").intent_code, NIFTI_INTENT_VECTOR);
    const std::vector<float> found = components_in(scene / "out_displacement.nii", 5);
    ASSERT_EQ(found.size(), expected.displacement.size());
    for (std::size_t c = 0; c < found.size(); ++c) {
      EXPECT_FLOAT_EQ(found[c], expected.displacement[c]) << expected.units << ' ' << c;
    }
  }
}

/// The box is beyond the grid at both steps: no voxel shows another sample.
TEST(CliFields, AForwardFieldMayChangeWhereTheVolumeDoesNot) {
  const Scene scene;
  write_mesh(scene / "mesh.vtkhdf", box_mesh(), shifts({100, 101}), {0, 1});

  const CommandResult result =
      scene.warp({"-o", "out.vtkhdf", "--temporal", "--outputs", "forward"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  for (const std::int64_t step : {0, 1}) {
    const Volume forward = read_volume(scene / "out.vtkhdf", "tetwarp_forward", step);
    EXPECT_EQ(forward.samples<float>()[3 * 17], 2.0F * static_cast<float>(100 + step));
  }
}
}  // namespace
}  // namespace tetwarp::test
