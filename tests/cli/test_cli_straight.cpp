/// @file test_cli_straight.cpp
/// NIfTI images and meshes of other programs straight in and out of `tetwarp warp`: the same voxels
/// and headers as through `import` and `export`.
#include <gtest/gtest.h>
#include <nifti1.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "tests/support/cli_scene.hpp"
#include "tests/support/foreign_meshes.hpp"
#include "tests/support/nifti_files.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

/// The scene with its volume as head.nii and head.nii.gz, of integers with a slope and facts.
class Straight : public testing::Test {
 protected:
  Straight() {
    NiftiFacts facts;
    facts.sform_code = 4;
    facts.qform_code = 0;
    facts.description = "by hand";
    const Volume volume = ramp_volume<std::int16_t>("values");
    for (const char* name : {"head.nii", "head.nii.gz"}) {
      write_nifti(scene / name, volume, Axes::ras, facts);
    }
  }

  void run(const Names& words, const std::string& warning = "") const {
    const CommandResult result = run_command(scene, words);
    ASSERT_EQ(result.exit_code, 0) << words.front() << ": " << result.err;
    EXPECT_NE(result.err.find(warning), std::string::npos) << result.err;
    if (warning.empty()) {
      EXPECT_EQ(result.err, "") << words.front();
    }
  }

  /// Step 3 through VTKHDF files: import, warp, export.
  std::string long_way(const std::string& image, Names more = {}) const {
    run({"import", image, "-o", "long_in.vtkhdf", "--quiet"});
    Names words{"warp", "long_in.vtkhdf", "mesh.vtkhdf", "-o", "long.vtkhdf", "--steps", "3"};
    words.insert(words.end(), more.begin(), more.end());
    run(words);
    run({"export", "long.vtkhdf", "--array", "values", "-o", "long.nii", "--quiet"});
    return text_of(scene / "long.nii");
  }

  /// The header of one file and the bytes of its samples; the fingerprint stands between them.
  static void expect_same_image(const std::string& found, const std::string& expected) {
    nifti_1_header a{}, b{};
    std::memcpy(&a, found.data(), sizeof a);
    std::memcpy(&b, expected.data(), sizeof b);
    EXPECT_TRUE(found.substr(static_cast<std::size_t>(a.vox_offset)) ==
                expected.substr(static_cast<std::size_t>(b.vox_offset)));
    a.vox_offset = b.vox_offset;
    EXPECT_EQ(std::memcmp(&a, &b, sizeof a), 0);
  }

  Scene scene;
};

TEST_F(Straight, IsImportWarpAndExportBitForBit) {
  for (const std::string input : {"head.nii", "head.nii.gz"}) {
    const std::string expected = long_way(input);

    run({"warp", input, "mesh.vtkhdf", "-o", "out.nii", "--steps", "3"});
    run({"warp", input, "mesh.vtkhdf", "-o", "out.nii.gz", "--steps", "3"});
    run({"warp", input, "mesh.vtkhdf", "-o", "out.vtkhdf", "--steps", "3"});

    expect_same_image(text_of(scene / "out.nii"), expected);
    EXPECT_TRUE(read_nifti(scene / "out.nii.gz").data == read_nifti(scene / "long.nii").data);
    EXPECT_EQ(read_nifti_facts(scene / "out.nii.gz"), read_nifti_facts(scene / "head.nii"));
    EXPECT_TRUE(text_of(scene / "out.vtkhdf") == text_of(scene / "long.vtkhdf"));
  }
}

/// Gzip files are unpacked to a temporary file where blocks of them are read and written.
TEST_F(Straight, IsTheSameInBlocks) {
  if (has_address_sanitizer) GTEST_SKIP() << "the address sanitizer takes more memory";
  Volume volume = make_volume(ramp_volume<float>().grid, PixelType::float32);
  volume.grid.dims = {160, 150, 140};
  volume.grid.spacing = {24.0 / 160, 20.0 / 150, 16.0 / 140};
  volume.data.resize(volume.byte_count());
  float value = 0;
  for (float& sample : volume.samples<float>()) sample = value = value > 1000 ? 0 : value + 1;
  write_nifti(scene / "large.nii", volume);
  write_nifti(scene / "large.nii.gz", volume);
  run({"warp", "large.nii", "mesh.vtkhdf", "-o", "whole.nii", "--steps", "3"});
  const Names before = scene.names();
  for (const std::string end : {".nii", ".nii.gz"}) {
    const Names words{"warp", "large" + end, "mesh.vtkhdf", "-o",        "out" + end, "--steps",
                      "3",    "--memory",    "58M",         "--threads", "2"};
    Names plan = words;
    plan.push_back("--dry-run");
    const CommandResult planned = run_command(scene, plan);
    EXPECT_NE(planned.out.find(" blocks of up to "), std::string::npos) << planned.err;
    const std::string disk = end == ".nii" ? "12.8 MiB of disk" : "25.6 MiB of disk";
    EXPECT_NE(planned.out.find(disk), std::string::npos) << planned.out;
    run(words);
    const Volume found = read_nifti(scene / ("out" + end));
    EXPECT_TRUE(found.data == read_nifti(scene / "whole.nii").data);
    fs::remove(scene / ("out" + end));
  }
  EXPECT_EQ(scene.names(), before);
}

TEST_F(Straight, ResumeKeepsCompleteImages) {
  const Names words{"warp",       "head.nii.gz", "mesh.vtkhdf", "-o",
                    "out.nii.gz", "--resume",    "--outputs",   "mask"};
  const CommandResult first = run_command(scene, words);
  EXPECT_NE(first.out.find("8 written"), std::string::npos) << first.out << first.err;
  fs::remove(scene / "out_0002_mask.nii.gz");

  const CommandResult again = run_command(scene, words);

  EXPECT_NE(again.out.find("2 written, 6 skipped"), std::string::npos) << again.out << again.err;
}

/// Each extra output is an image of its own, as export would write it.
TEST_F(Straight, WritesAnImageForEachArray) {
  const Names outputs{"--outputs", "displacement,tet"};
  long_way("head.nii", outputs);
  for (const std::string array : {"displacement", "tet"}) {
    run({"export", "long.vtkhdf", "--array", "tetwarp_" + array, "-o", "long_" + array + ".nii",
         "--quiet"});
  }

  run({"warp", "head.nii", "mesh.vtkhdf", "-o", "out.nii", "--steps", "3", "--outputs",
       "displacement,tet"});

  for (const std::string name : {".nii", "_displacement.nii", "_tet.nii"}) {
    expect_same_image(text_of(scene / ("out" + name)), text_of(scene / ("long" + name)));
  }
  EXPECT_EQ(header_in(scene / "out_displacement.nii").intent_code, NIFTI_INTENT_VECTOR);
}

TEST_F(Straight, TakesMeshesOfVtkAndGmsh) {
  write_text(scene / "m.vtk", legacy_vtk(box_mesh(), shifts({3})[0]));
  write_text(scene / "m.msh", msh(box_mesh(), shifts({3})[0]));
  write_text(scene / "rest.vtk", legacy_vtk(box_mesh()));
  const std::string missing = missing_readers(scene, {"m.vtk", "m.msh"});
  if (!missing.empty()) GTEST_SKIP() << missing;
  const CommandResult vtk = run_command(scene, {"info", "m.vtk"});
  EXPECT_NE(vtk.out.find("kind: mesh\nnodes: 8\ntetrahedra: 5\n"), std::string::npos) << vtk.out;
  long_way("head.nii");
  const std::vector<std::byte> expected = read_nifti(scene / "long.nii").data;

  for (const Names& mesh : std::vector<Names>{
           {"m.vtk"}, {"m.msh", "--displacement", "u"}, {"mesh.vtkhdf", "--rest", "rest.vtk"}}) {
    Names words{"warp", "head.nii", mesh.front(), "-o", "out.nii", "--steps", "-1"};
    words.insert(words.end(), mesh.begin() + 1, mesh.end());
    run(words);
    EXPECT_TRUE(read_nifti(scene / "out.nii").data == expected) << mesh.front();
  }
  run({"deform", "m.msh", "-o", "bent.vtkhdf", "--steps", "1", "--quiet"},
      "m.msh: left out: cell array 'group', data 'u'");
  EXPECT_EQ(MeshReader(scene / "bent.vtkhdf").header().tet_count, 5);
}

/// A mesh in LPS lies where its turned copy does; vectors of the image turn, too.
TEST_F(Straight, AxesTurnMeshesAndVectors) {
  Mesh mesh = box_mesh();
  std::vector<Point3> shift = shifts({3})[0];
  const auto turn = [](std::vector<Point3>& points) {
    for (Point3& point : points) point = {-point[0], -point[1], point[2]};
  };
  turn(mesh.rest_positions);
  turn(shift);
  write_text(scene / "lps.vtk", legacy_vtk(mesh, shift));
  const std::string missing = missing_readers(scene, {"lps.vtk"});
  if (!missing.empty()) GTEST_SKIP() << missing;
  long_way("head.nii");

  run({"warp", "head.nii", "lps.vtk", "--axes", "lps", "-o", "out.nii"});
  EXPECT_TRUE(read_nifti(scene / "out.nii").data == read_nifti(scene / "long.nii").data);

  nifti_1_header header = float_header({12, 10, 8}, 3);
  header.intent_code = NIFTI_INTENT_VECTOR;
  header.sform_code = NIFTI_XFORM_SCANNER_ANAT;
  header.srow_x[0] = header.srow_y[1] = header.srow_z[2] = 2;
  header.srow_x[3] = 5;
  header.srow_y[3] = -3;
  header.srow_z[3] = 100;
  write_constant(scene / "vectors.nii", header, {1, 2, 3});
  run({"warp", "vectors.nii", "mesh.vtkhdf", "--axes", "lps", "-o", "out.nii", "--steps", "0"});
  EXPECT_EQ(components_in(scene / "out.nii", 0), (std::vector<float>{1, 2, 3}));
  run({"warp", "vectors.nii", "mesh.vtkhdf", "--axes", "lps", "-o", "out.vtkhdf", "--steps", "0"});
  const Volume turned = read_volume(scene / "out.vtkhdf");
  EXPECT_EQ(turned.samples<float>()[0], -1);
  EXPECT_EQ(turned.samples<float>()[2], 3);
}

/// A 4D image: steps of 2 s, the second and the third brighter.
class StraightSeries : public Straight {
 protected:
  StraightSeries() {
    NiftiFacts facts;
    facts.xyzt_units = 2 | 16;  // mm, milliseconds
    for (const char* name : {"series.nii", "series.nii.gz"}) {
      Volume volume = ramp_volume<float>("values");
      BlockVolumeWriter writer(scene / name, volume.grid,
                               {{"values", PixelType::float32, 1, facts}}, {}, true);
      for (int step = 0; step < 3; ++step) {
        for (float& sample : volume.samples<float>()) sample += static_cast<float>(step);
        writer.begin_step(2.0 * step);
        writer.write(0, {{0, 0, 0}, volume.grid.dims}, volume.data.data());
      }
      writer.finish();
    }
  }
};

TEST_F(StraightSeries, KeepsStepsAndTimes) {
  EXPECT_EQ(header_in(scene / "series.nii").dim[0], 4);
  EXPECT_EQ(header_in(scene / "series.nii").dim[4], 3);
  EXPECT_EQ(header_in(scene / "series.nii").pixdim[4], 2000);
  const VolumeHeader header = read_volume_header(scene / "series.nii.gz");
  EXPECT_EQ(header.times, (std::vector<double>{0, 2, 4}));

  run({"import", "series.nii.gz", "-o", "series.vtkhdf", "--quiet"});
  EXPECT_EQ(read_volume_header(scene / "series.vtkhdf").times, header.times);
  run({"export", "series.vtkhdf", "--temporal", "-o", "back.nii", "--quiet"});
  EXPECT_TRUE(text_of(scene / "back.nii") == text_of(scene / "series.nii"));
  run({"export", "series.vtkhdf", "--step", "1", "-o", "one.nii", "--quiet"});
  EXPECT_TRUE(read_nifti(scene / "one.nii").data ==
              read_nifti(scene / "series.nii", Axes::ras, 1).data);
}

TEST_F(StraightSeries, PairsItsStepsWithThoseOfTheMesh) {
  run({"import", "series.nii", "-o", "in.vtkhdf", "--quiet"});
  run({"warp", "in.vtkhdf", "mesh.vtkhdf", "-o", "expected.vtkhdf", "--pair", "--steps", "0:3",
       "--temporal"});
  for (const std::string end : {".nii", ".nii.gz"}) {
    const Names words{"warp",   "series" + end, "mesh.vtkhdf", "-o",        "out" + end,
                      "--pair", "--steps",      "0:3",         "--temporal"};
    run(words);
    const VolumeHeader header = read_volume_header(scene / ("out" + end));
    EXPECT_EQ(header.times, (std::vector<double>{0, 0.5, 1}));
    for (int step = 0; step < 3; ++step) {
      EXPECT_TRUE(read_volume(scene / ("out" + end), "", step).data ==
                  read_volume(scene / "expected.vtkhdf", "", step).data)
          << step;
    }
  }
  run({"warp", "series.nii.gz", "mesh.vtkhdf", "-o", "files.nii.gz", "--pair", "--steps", "0:3"});
  EXPECT_TRUE(read_nifti(scene / "files_0001.nii.gz").data ==
              read_volume(scene / "expected.vtkhdf", "", 1).data);
  run({"warp", "series.nii.gz", "mesh.vtkhdf", "-o", "uneven.nii", "--pair", "--steps", "0,1,2",
       "--temporal", "--resume"});
  const CommandResult uneven =
      run_command(scene, {"warp", "head.nii", "mesh.vtkhdf", "-o", "uneven.nii", "--steps", "0,1,3",
                          "--temporal", "--strict"});
  EXPECT_EQ(uneven.exit_code, 1);
  EXPECT_NE(uneven.err.find("not equally spaced"), std::string::npos) << uneven.err;
}

/// Images of one slice, along each axis.
TEST_F(Straight, WarpsASingleSlice) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Volume slice = ramp_volume<float>("values");
    slice.grid.dims[axis] = 1;
    slice.grid.origin[axis] += 6;
    slice.data.resize(slice.byte_count());
    write_nifti(scene / "slice.nii.gz", slice);

    run({"warp", "slice.nii.gz", "mesh.vtkhdf", "-o", "still.nii.gz", "--steps", "0"});
    run({"warp", "slice.nii.gz", "mesh.vtkhdf", "-o", "moved.nii.gz", "--steps", "3", "--filter",
         "bspline"});
    const CommandResult picture = run_command(scene, {"render", "slice.nii.gz", "-o", "a.png"});
    const std::string sizes[] = {"450 x 360", "540 x 360", "432 x 360"};  // 10:8, 12:8, 12:10
    EXPECT_TRUE(picture.out.starts_with(sizes[axis])) << picture.out;
    run({"mesh", "slice.nii.gz", "-o", "slice.vtkhdf", "--quiet"});

    EXPECT_TRUE(read_nifti(scene / "still.nii.gz").data == slice.data) << axis;
    const Volume moved = read_nifti(scene / "moved.nii.gz");
    if (axis == 0) continue;
    for (std::int64_t i = 3; i < 12; ++i) {  // the mesh moves by three voxels along i
      const auto at = static_cast<std::size_t>(i);
      EXPECT_EQ(moved.samples<float>()[at], slice.samples<float>()[at - 3]) << axis << " " << i;
    }
  }
}

TEST_F(Straight, SeveralImagesGoToAFolder) {
  run({"warp", "head.nii", "head.nii.gz", "volume.vtkhdf", "mesh.vtkhdf", "-o", "all", "--steps",
       "3"});

  Names names;
  for (const auto& entry : fs::directory_iterator(scene / "all")) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (Names{"head.nii", "head.nii.gz", "volume.vtkhdf"}));
}
}  // namespace
}  // namespace tetwarp::test
