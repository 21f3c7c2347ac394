/// @file test_cli_bad_images.cpp
/// Damaged and contradictory images and meshes straight into the command, and outputs that cannot
/// be: one line with file and remedy, a non-zero exit code, nothing left behind.
#include <gtest/gtest.h>
#include <nifti1.h>

#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/cli_scene.hpp"
#include "tests/support/foreign_meshes.hpp"
#include "tests/support/nifti_files.hpp"
#include "tests/support/refused_line.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;
constexpr float no_number = std::numeric_limits<float>::quiet_NaN();
constexpr float infinite = std::numeric_limits<float>::infinity();

/// The header of a 4 x 3 x 2 float32 image, changed.
struct BadHeader {
  std::function<void(nifti_1_header&)> change;
  std::string phrase;
};

TEST(BadImages, HeadersThatContradictThemselves) {
  const Scene scene;
  const auto set_sform = [](nifti_1_header& header, const std::vector<float>& diagonal) {
    header.sform_code = 1;
    header.srow_x[0] = diagonal[0];
    header.srow_y[1] = diagonal[1];
    header.srow_z[2] = diagonal[2];
  };
  const auto set_series = [](nifti_1_header& header, short steps) {
    header.dim[0] = 4;
    header.dim[4] = steps;
  };
  const std::vector<BadHeader> cases = {
      {[](auto& h) { h.dim[0] = 0; }, "bad.nii: dim[0]: is 0 axes, expected 1 to 7"},
      {[](auto& h) { h.dim[0] = 9; }, "bad.nii: dim[0]: is 9 axes, expected 1 to 7"},
      {[](auto& h) { h.dim[1] = 0; }, "dim[1]: is 0, expected 1 or more; correct the header"},
      {[](auto& h) { h.dim[2] = -5; }, "dim[2]: is -5, expected 1 or more; correct the header"},
      {[](auto& h) { h.dim[1] = h.dim[2] = h.dim[3] = 32767; }, "truncated or damaged, copy it"},
      {[](auto& h) { h.dim[3] = 3; }, "is too small: truncated or damaged, copy it again"},
      {[](auto& h) { h.dim[5] = 12; }, "dim[5]: is 12 components, expected 1 to 9"},
      {[](auto& h) { h.dim[0] = 6, h.dim[6] = 2; }, "dim[6]: is 2, expected 1: only volumes"},
      {[](auto& h) { h.pixdim[2] = no_number; }, "pixdim[2]: is nan, expected the size of a"},
      {[](auto& h) { h.pixdim[1] = infinite; }, "pixdim[1]: is inf, expected the size of a voxel"},
      {[](auto& h) { h.pixdim[3] = -2; }, "pixdim[3]: is -2.000000, expected the size of a voxel"},
      {[&](auto& h) {
         set_sform(h, {0, 0, 0});
       },
       "bad.nii: sform: grid: "},
      {[&](auto& h) {
         set_sform(h, {1, 0, 1});
       },
       "bad.nii: sform: grid: "},
      {[&](auto& h) {
         set_sform(h, {1, no_number, 1});
       },
       "sform: holds a number that is not"},
      {[](auto& h) { h.qform_code = 1, h.qoffset_x = infinite; }, "qform: holds a number that is"},
      {[](auto& h) { h.qform_code = 1, h.quatern_c = no_number; }, "qform: holds a number"},
      {[](auto& h) { h.datatype = DT_RGB24; }, "bitpix: is 32, but colors have 24"},
      {[](auto& h) { h.datatype = DT_COMPLEX64; }, "datatype: is 32 (COMPLEX64), expected"},
      {[](auto& h) { h.datatype = 0; }, "datatype: is 0 (UNKNOWN), expected integers or floats"},
      {[](auto& h) { h.bitpix = 16; }, "bitpix: is 16, but samples of datatype 16 (float32)"},
      {[](auto& h) { h.vox_offset = no_number; }, "vox_offset: is nan, expected at least 352"},
      {[](auto& h) { h.vox_offset = 1e9F; }, "from byte 1000000000.000000 on, but the file"},
      {[](auto& h) { h.scl_slope = 2, h.scl_inter = infinite; },
       "scl_inter: is inf, expected a fi"},
      {[](auto& h) { h.scl_slope = h.scl_inter = 3e38F; }, "scl_slope: and scl_inter make samples"},
      {[](auto& h) { h.qform_code = 1, h.quatern_b = h.quatern_c = 1; },
       "qform: has a quaternion of length 1.414214, expected at most 1; correct the header"},
      {[](auto& h) { h.dim[5] = 5, h.intent_code = NIFTI_INTENT_SYMMATRIX; },
       "dim[5]: is 5 components, but intent_code 1005, symmetric matrices, has 6"},
      {[](auto& h) { h.dim[5] = 4, h.intent_code = NIFTI_INTENT_DISPVECT; },
       "dim[5]: is 4 components, but intent_code 1006, displacements, has 3; correct the header"},
      {[](auto& h) { h.vox_offset = 348; }, "vox_offset: is 348.000000, expected at least 352;"},
      {[](auto& h) { h.dim[0] = 7, h.dim[7] = 2; }, "dim[7]: is 2, expected 1: only volumes"},
      {[](auto& h) { h.datatype = 1536; }, "datatype: is 1536 (FLOAT128), expected integers or"},
      {[](auto& h) { h.datatype = 1; }, "datatype: is 1 (BINARY), expected integers or floats"},
      {[&](auto& h) {
         set_sform(h, {1, 1, 1});
         h.srow_x[1] = 1, h.srow_y[1] = 0;
       },
       "sform: grid: direction is singular, expected three independent axes; correct the header"},
      {[&](auto& h) { set_series(h, 3), h.intent_code = NIFTI_INTENT_VECTOR; },
       "intent_code: is 1007, vectors or tensors, whose components lie along dim[5]"},
      {[&](auto& h) { set_series(h, 6), h.intent_code = NIFTI_INTENT_SYMMATRIX; },
       "but dim[5] is 1 and dim[4] is 6; move the components to dim[5]"},
      {[&](auto& h) { set_series(h, 2); }, "is too small: truncated or damaged, copy it again"},
      {[&](auto& h) { set_series(h, 2), h.dim[3] = 1, h.pixdim[4] = no_number; },
       "pixdim[4]: gives no times to the 2 steps; correct the header"},
      {[&](auto& h) { set_series(h, 2), h.dim[3] = 1, h.toffset = infinite; },
       "toffset: gives no times to the 2 steps; correct the header"}};
  for (const BadHeader& bad : cases) {
    nifti_1_header header = float_header({4, 3, 2}, 1);
    write_constant(scene / "bad.nii", header, {7});
    bad.change(header);
    std::string bytes = text_of(scene / "bad.nii");
    std::memcpy(bytes.data(), &header, sizeof header);
    write_text(scene / "bad.nii", bytes);
    expect_refused_line(scene, {"warp", "bad.nii", "mesh.vtkhdf", "-o", "out.nii.gz"}, bad.phrase);
  }
}

/// Changes the bytes of a file.
std::string changed(std::string bytes, std::size_t at, const std::string& by) {
  return bytes.replace(at, by.size(), by);
}

TEST(BadImages, FilesThatEndEarlyOrAreSomethingElse) {
  const Scene scene;
  const Volume volume = ramp_volume<float>();
  write_nifti(scene / "head.nii", volume);
  write_nifti(scene / "head.nii.gz", volume);
  const std::string plain = text_of(scene / "head.nii");
  const std::string gzip = text_of(scene / "head.nii.gz");
  std::string second(540, '\0');
  second = changed(second, 0, std::string("\x1c\x02\0\0n+2\0\r\n\032\n\x10\0\x20\0", 16));
  for (int axis = 0; axis < 4; ++axis) second[16 + 8 * static_cast<std::size_t>(axis)] = 3;
  struct Case {
    std::string name;
    std::string bytes;
    std::string phrase;
  };
  const std::string pair = changed(plain, 344, "ni1");
  for (const Case& bad : std::vector<Case>{
           {"a.nii", plain.substr(0, plain.size() - 1), "a.nii: the header declares 3.8 KiB of"},
           {"b.nii", plain.substr(0, 200),
            "b.nii: is a file without a NIfTI header (damaged, trunc"},
           {"c.nii.gz", gzip.substr(0, gzip.size() / 2),
            "c.nii.gz: ends early or has a wrong checks"},
           {"d.nii.gz", changed(gzip, gzip.size() - 6, "????"),
            "d.nii.gz: is a file without a NIfTI header (damaged"},
           {"e.nii", "a letter to a friend", "e.nii: is a file without a NIfTI header (damaged"},
           {"f.nii.gz", "", "f.nii.gz: is empty, expected a volume; copy it again"},
           {"g.hdr", changed(plain, 344, std::string(4, '\0')), "Analyze images have no orient"},
           {"h.hdr", pair, "h.hdr: has no file of samples beside it; copy 'h.img', too"},
           {"i.nii", second.substr(0, 400), "i.nii: is a file without a NIfTI header (damaged"},
           {"j.nii", changed(second, 30, "\x7f"), "expected"},
           {"k.nii", plain + "", "k.nii: is also an input; name another output"}}) {
    write_text(scene / bad.name, bad.bytes);
    const std::string output = bad.name == "k.nii" ? "k.nii" : "out.nii";
    expect_refused_line(scene, {"warp", bad.name, "mesh.vtkhdf", "-o", output, "--steps", "0"},
                        bad.phrase);
  }
  write_text(scene / "h.img", "too short");
  expect_refused_line(scene, {"render", "h.hdr", "-o", "out.png"},
                      "but 'h.img' is too small: truncated");
  expect_refused_line(scene, {"info", "h.img"}, "h.img: the header declares 3.8 KiB of samples");
}

TEST(BadImages, MeshesThatCannotBe) {
  const Scene scene;
  write_nifti(scene / "head.nii", ramp_volume<float>());
  const std::string good = legacy_vtk(box_mesh(), shifts({3})[0]);
  write_text(scene / "good.vtk", good);
  write_text(scene / "good.msh", msh(box_mesh()));
  const std::string missing = missing_readers(scene, {"good.vtk", "good.msh"});
  if (!missing.empty()) GTEST_SKIP() << missing;
  const auto with = [&](const std::string& from, const std::string& to) {
    return changed(
        good.substr(0, good.find(from)) + to + good.substr(good.find(from) + from.size()), 0, "#");
  };
  Mesh bad_node = box_mesh();
  bad_node.rest_positions[3][1] = std::numeric_limits<double>::quiet_NaN();
  const std::string points = good.substr(0, good.find("CELLS"));
  struct Case {
    std::string name;
    std::string text;
    std::string phrase;
  };
  for (const Case& bad : std::vector<Case>{
           {"a.vtk", points, "a.vtk: "},
           {"b.vtk", points + "CELLS 1 11\n10 0 1 2 3 4 5 6 7 0 1\nCELL_TYPES 1\n15\n",
            "split the cells"},
           {"c.vtk",
            points + "CELLS 1 21\n20 0 1 2 3 4 5 6 7 0 1 2 3 4 5 6 7 0 1 2 3\nCELL_TYPES 1\n25\n",
            "split the cells"},
           {"d.vtk", points + "CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n5\n", "or a surface mesh"},
           {"e.vtk", with("4.000000", "nan"),
            "e.vtk: holds no unstructured grid that VTK can read"},
           {"f.vtk", with("4 0 3 5 6", "4 0 3 5 60"), "f.vtk: "},
           {"g.msh", msh(bad_node),
            "g.msh: mesh: rest position of node 3 is not finite: damaged, write it again"},
           {"h.vtu", "a letter to a friend", "h.vtu: "},
           {"i.msh", "", "i.msh: "},
           {"j.msh", "Exit;", "j.msh: "},
           {"k.msh", msh(box_mesh()).substr(0, 300), "k.msh: "}}) {
    write_text(scene / bad.name, bad.text);
    expect_refused_line(scene, {"warp", "head.nii", bad.name, "-o", "out.nii"}, bad.phrase);
  }
  Mesh small = box_mesh();
  small.rest_positions.resize(7);
  small.tets.resize(4);
  write_text(scene / "small.vtk", legacy_vtk(small));
  struct Options {
    Names words;
    std::string phrase;
  };
  for (const Options& bad : std::vector<Options>{
           {{"good.vtk", "--displacement", "u"}, "u: no such point array; the file has displac"},
           {{"mesh.vtkhdf", "--displacement", "u"}, "is a VTKHDF mesh, whose displacement is"},
           {{"mesh.vtkhdf", "--axes", "lps"}, "--axes lps turns nothing: it is for meshes in"},
           {{"good.vtk", "--rest-step", "1"}, "good.vtk: has no step 1 of points"},
           {{"good.vtk", "--rest", "small.vtk"}, "small.vtk: has 7 nodes, the mesh has 8"},
           {{"good.vtk", "--rest", "absent.vtk"}, "absent.vtk: cannot be opened"},
           {{"head.nii"}, "head.nii: is a NIfTI image, expected a mesh; the order is"}}) {
    Names words{"warp", "head.nii"};
    words.insert(words.end(), bad.words.begin(), bad.words.end());
    words.insert(words.end(), {"-o", "out.nii"});
    expect_refused_line(scene, words, bad.phrase);
  }
  expect_refused_line(scene, {"warp", "good.vtk", "mesh.vtkhdf", "-o", "out.nii"},
                      "good.vtk: is a mesh, expected a volume; the order is");
  expect_refused_line(scene, {"deform", "mesh.vtkhdf", "--axes", "lps", "-o", "out.vtkhdf"},
                      "mesh.vtkhdf: is a VTKHDF mesh, which is not turned; leave out --axes");
}

TEST(BadImages, OutputsThatCannotBe) {
  const Scene scene;
  write_nifti(scene / "head.nii.gz", ramp_volume<float>());
  nifti_1_header series = float_header({3, 2, 2}, 1);
  series.dim[4] = 2;
  write_constant(scene / "series.nii", series, {1, 2});
  fs::create_directory(scene / "folder.nii.gz");
  struct Case {
    Names words;
    std::string phrase;
  };
  const auto warp = [](const std::string& volume, Names more) {
    more.insert(more.begin(), {"warp", volume, "mesh.vtkhdf", "-o"});
    return more;
  };
  for (const Case& bad : std::vector<Case>{
           {warp("head.nii.gz", {"out.tif"}), "out.tif: the name of a volume ends in .vtkhdf, .hd"},
           {warp("head.nii.gz", {"out.gz"}), "out.gz: the name of a volume ends in .vtkhdf, .hdf"},
           {warp("head.nii.gz", {"head.nii.gz", "--steps", "0"}), "head.nii.gz: is also an input"},
           {warp("head.nii.gz", {"folder.nii.gz", "--steps", "0"}), "is a folder; name the file"},
           {warp("head.nii.gz",
                 {"out.nii", "--steps", "0", "--outputs", "mask", "--report", "out_mask.nii"}),
            "out_mask.nii: would be written twice"},
           {warp("head.nii.gz", {"out.nii", "--array", "ct"}),
            "no such array; the file has values"},
           {warp("head.nii.gz", {"out.nii", "--source-step", "5"}), "the volume has 1 (0 to 0)"},
           {warp("series.nii", {"out.nii", "--pair"}),
            "--pair: step 3 of the mesh has no pair, the volume has 2 (0 to 1); choose steps"},
           {{"export", "head.nii.gz", "-o", "folder.nii.gz"}, "is a folder; name the file to"},
           {{"export", "series.nii", "--step", "2", "-o", "out.nii"},
            "has no step 2, its steps are"},
           {{"mesh", "series.nii", "-o", "out.nii"}, "the name of a VTKHDF file ends in .vtkhdf"},
           {{"mesh", "series.nii", "--step", "7", "-o", "out.h5"}, "series.nii: has no step 7"}}) {
    expect_refused_line(scene, bad.words, bad.phrase);
  }
  if (geteuid() == 0) return;  // root can write to any folder
  fs::create_directory(scene / "locked");
  fs::permissions(scene / "locked", fs::perms::owner_read | fs::perms::owner_exec);
  expect_refused_line(scene, warp("head.nii.gz", {"locked/out.nii.gz", "--steps", "0"}),
                      "no permission");
}

/// A full disk, while an image is written whole and while a gzip image is unpacked for blocks.
TEST(BadImages, AFullDiskLeavesNothing) {
  const Scene scene;
  Volume volume = make_volume(ramp_volume<float>().grid, PixelType::float32);
  volume.grid.dims = {160, 150, 140};
  volume.grid.spacing = {24.0 / 160, 20.0 / 150, 16.0 / 140};
  volume.data.resize(volume.byte_count());
  write_nifti(scene / "large.nii.gz", volume);
  RunOptions full;
  full.file_size_limit = 1 << 20;
  const Names warp{"warp", "large.nii.gz", "mesh.vtkhdf", "-o", "out.nii", "--steps", "3"};

  expect_refused_line(scene, warp, "out.nii: cannot be written", full);

  Names blocks = warp;
  blocks.insert(blocks.end(), {"--memory", "58M", "--threads", "2"});
  expect_refused_line(scene, blocks, "large.nii.gz: cannot be unpacked beside the output", full);
}
}  // namespace
}  // namespace tetwarp::test
