/// @file test_cli_bad_input.cpp
/// Bad arguments and bad files: one line that names the argument or file, the exit code, and no
/// output.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <tetwarp/backend.hpp>
#include <utility>
#include <vector>

#include "tests/support/cli_scene.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

/// A command line that must fail, and words that its message must contain.
struct Refused {
  Names words;
  std::string message;
};

void expect_refused(const Scene& scene, const Refused& refused, int exit_code) {
  const Names before = scene.names();

  const CommandResult result = run_command(scene, refused.words);

  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_TRUE(result.has_one_line_error()) << result.err;
  EXPECT_NE(result.err.find(refused.message), std::string::npos) << result.err;
  EXPECT_EQ(scene.names(), before);
}

/// `tetwarp warp volume.vtkhdf mesh.vtkhdf -o out.vtkhdf` with more words.
Names warp_with(Names more) {
  more.insert(more.begin(), {"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "out.vtkhdf"});
  return more;
}

TEST(UsageError, ExitsWithTwoAndNamesTheHelp) {
  const Scene scene;
  for (const Refused& refused : std::vector<Refused>{
           {{}, "tetwarp --help"},
           {{"wrap"}, "'wrap'"},
           {{"warp"}, "tetwarp warp --help"},
           {{"warp", "volume.vtkhdf", "-o", "out.vtkhdf"}, "MESH"},
           {{"warp", "volume.vtkhdf", "mesh.vtkhdf"}, "-o OUT"},
           {warp_with({"--filter", "cubical"}), "linear, nearest, cubic, bspline, lanczos, labels"},
           {warp_with({"--overshoot", "cut"}), "keep, clamp"},
           {warp_with({"--background", "black"}), "--background"},
           {warp_with({"--antialias", "--filter", "nearest"}), "use another --filter"},
           {warp_with({"--intensity", "conservative", "--filter", "cubic"}), "--filter: "},
           {warp_with({"--intensity", "mass"}), "value, density, conservative"},
           {warp_with({"--vectors", "flow=twisted"}), "rotate, covariant, contravariant"},
           {warp_with({"--dims", "1,2"}), "--dims"},
           {warp_with({"--roi", "0:4,0:4"}), "'0:4,0:4'"},
           {warp_with({"--steps", "0:4:0"}), "stride"},
           {warp_with({"--steps", "first"}), "'first'"},
           {warp_with({"--threads", "-1"}),
            "--threads: '-1' is not a whole number from 0 to 1024 (see"},
           {warp_with({"--threads", "100000"}), "--threads: '100000' is above 1024 (see"},
           {warp_with({"--threads", "two"}), "'two' is not a whole number from 0 to 1024 (see"},
           {warp_with({"--source-step", "-1"}), "'-1' is not a whole number of 0 or more (see"},
           {warp_with({"--device", "9999999999"}), "'9999999999' is above 2147483647 (see"},
           {{"export", "volume.vtkhdf", "-o", "a.nii", "--step", "-1"}, "of 0 or more (see"},
           {{"deform", "mesh.vtkhdf", "-o", "a.vtkhdf", "--seed", "-1"}, "of 0 or more (see"},
           {{"deform", "mesh.vtkhdf", "-o", "a.vtkhdf", "--steps", "0"}, "from 1 to 1000000 (see"},
           {warp_with({"--compress", "11"}), "--compress"},
           {warp_with({"--outputs", "mask,depth"}), "'depth'"},
           {warp_with({"--no-skip", "work"}), "'work'"},
           {warp_with({"--velocity", "3"}), "--velocity"},
           {warp_with({"--batch", "jobs.json"}), "--batch"},
           {{"mesh", "volume.vtkhdf"}, "tetwarp mesh --help"},
           {{"deform", "mesh.vtkhdf", "-o", "out.vtkhdf", "--kind", "melt"}, "'melt'"}}) {
    expect_refused(scene, refused, 2);
  }
}

TEST(BadInput, NamesTheFileThatCannotBeRead) {
  const Scene scene;
  write_text(scene / "notes.txt", "not a volume");
  for (const Refused& refused : std::vector<Refused>{
           {{"warp", "none.vtkhdf", "mesh.vtkhdf", "-o", "out.vtkhdf"}, "none.vtkhdf"},
           {{"warp", "volume.vtkhdf", "none.vtkhdf", "-o", "out.vtkhdf"}, "none.vtkhdf"},
           {{"warp", "notes.txt", "mesh.vtkhdf", "-o", "out.vtkhdf"}, "notes.txt"},
           {{"info", "notes.txt"}, "notes.txt"},
           {{"import", "volume.vtkhdf", "-o", "out.vtkhdf"}, "is a volume, expected a NIfTI"},
           {{"render", "mesh.vtkhdf", "-o", "out.png"}, "is a mesh, expected a volume"},
           {warp_with({"--rest", "none.vtkhdf"}), "none.vtkhdf"},
           {warp_with({"--vectors", "flow"}), "--vectors: no such array"},
           {warp_with({"--tensors", "density=principal"}),
            "density: quantities: a tensor has 6 components, the source 1"},
           {warp_with({"--grid", "none.vtkhdf"}), "none.vtkhdf"}}) {
    expect_refused(scene, refused, 1);
  }
}

TEST(BadInput, DistinguishesSwappedVolumeAndMesh) {
  const Scene scene;
  expect_refused(scene,
                 {{"warp", "mesh.vtkhdf", "volume.vtkhdf", "-o", "out.vtkhdf"},
                  "mesh.vtkhdf: is a mesh, expected a volume; the order is"},
                 1);
}

TEST(BadInput, RefusesAnOutputThatCannotBe) {
  const Scene scene;
  fs::create_directory(scene / "folder.vtkhdf");
  const auto warp_to = [](const std::string& output) {
    return Names{"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", output, "--steps", "0"};
  };
  for (const Refused& refused : std::vector<Refused>{
           {warp_to("volume.vtkhdf"), "is also an input"},
           {warp_to("./folder.vtkhdf/../mesh.vtkhdf"), "is also an input"},
           {warp_to("folder.vtkhdf"), "is a folder"},
           {warp_to("out.tif"), ".nrrd, .mha, .mhd, .mgh, .mgz or .vti"},
           {{"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "out.vtkhdf", "--report",
             "volume.vtkhdf"},
            "is also an input"},
           {{"warp", "volume.vtkhdf", "volume.vtkhdf", "mesh.vtkhdf", "-o", "out"},
            "written twice"},
           {{"warp", "volume.vtkhdf", "volume.vtkhdf", "mesh.vtkhdf", "-o", ".", "--steps", "0"},
            "is also an input"},
           {{"mesh", "volume.vtkhdf", "-o", "volume.vtkhdf"}, "is also an input"},
           {{"export", "volume.vtkhdf", "-o", "out.tif"}, ".nii.gz"},
           {{"render", "volume.vtkhdf", "-o", "out.jpg"}, ".png"}}) {
    expect_refused(scene, refused, 1);
  }
}

/// By all commands that read files of its name.
TEST(BadInput, RefusesAFolderAsAnyInput) {
  const Scene scene;
  // v, m: volume and mesh or transform of warp; p: points; i: import; c: contact.
  for (const auto& [end, readers] :
       {std::pair{"csv", "p"}, {"fcsv", "p"}, {"h5", "mc"},       {"mat", "m"},    {"mha", "vi"},
        {"mrk.json", "p"},     {"msh", "mi"}, {"nii", "vmi"},     {"nii.gz", "v"}, {"nrrd", "vm"},
        {"obj", "p"},          {"ply", "p"},  {"stl", "p"},       {"tfm", "m"},    {"tsv", "pc"},
        {"txt", "m"},          {"vtk", "mp"}, {"vtkhdf", "vmpi"}, {"vtp", "p"},    {"vtu", "mi"}}) {
    const std::string folder = std::string("folder.") + end;
    fs::create_directory(scene / folder);
    const std::map<char, Names> commands{{'v', {"warp", folder, "mesh.vtkhdf", "-o", "a.vtkhdf"}},
                                         {'m', {"warp", "volume.vtkhdf", folder, "-o", "a.vtkhdf"}},
                                         {'p', {"points", folder, "mesh.vtkhdf", "-o", "a.csv"}},
                                         {'i', {"import", folder, "-o", "a.vtkhdf"}},
                                         {'c', {"contact", folder, "-o", "a.h5"}}};
    for (const char reader : std::string(readers)) {
      expect_refused(scene, {commands.at(reader), folder + ": "}, 1);
    }
  }
  fs::create_directory(scene / "folder.json");
  expect_refused(scene, {{"simulate", "folder.json", "-o", "a"}, "folder.json: is a folder"}, 1);
  expect_refused(scene, {{"warp", "--batch", "folder.json"}, "folder.json: is a folder"}, 1);
  fs::create_directory(scene / "mouth");
  expect_refused(scene, {{"simulate", "mouth", "-o", "a"}, "give --scene mouth"}, 1);
}

TEST(BadInput, RefusesALinkToAnInputAsOutput) {
  const Scene scene;
  fs::create_symlink(scene / "volume.vtkhdf", scene / "link.vtkhdf");
  const std::string before = text_of(scene / "volume.vtkhdf");

  expect_refused(
      scene,
      {{"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "link.vtkhdf", "--steps", "0"}, "an input"},
      1);

  EXPECT_EQ(text_of(scene / "volume.vtkhdf"), before);
}

TEST(BadInput, RefusesAFolderWithoutPermission) {
  if (geteuid() == 0) GTEST_SKIP() << "root can write to any folder";
  const Scene scene;
  fs::create_directory(scene / "locked");
  fs::permissions(scene / "locked", fs::perms::owner_read | fs::perms::owner_exec);

  expect_refused(
      scene, {{"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "locked/out.vtkhdf"}, "permission"},
      1);
}

TEST(BadInput, ListsWhatExistsWhenSomethingDoesNot) {
  const Scene scene;
  for (const Refused& refused :
       std::vector<Refused>{{warp_with({"--steps", "4"}), "there are 4 (0 to 3)"},
                            {warp_with({"--steps", "2:2"}), "selects none of its 4 steps"},
                            {warp_with({"--source-step", "1"}), "the volume has 1 (0 to 0)"},
                            {warp_with({"--array", "pressure"}), "density"},
                            {warp_with({"--rest-step", "99"}), "99"}}) {
    expect_refused(scene, refused, 1);
  }
}

TEST(BadInput, ChecksGridAndRegionBeforeAnyWork) {
  const Scene scene;
  for (const Refused& refused : std::vector<Refused>{
           {warp_with({"--roi", "0:13,0:10,0:8"}), "not within 0 to 12"},
           {warp_with({"--roi=-1:3,0:10,0:8"}), "--roi: region: -1 to 3 on axis 0"},
           {warp_with({"--roi", "3:3,0:10,0:8"}), "3 to 3 on axis 0"},
           {warp_with({"--dims", "0,4,4"}), "output grid"},
           {warp_with({"--dims", "100000,100000,100000"}), "TiB"},
           {warp_with({"--dims", "2000000000,2,2"}), "output grid"},
           {warp_with({"--spacing", "0,1,1"}), "spacing"},
           {warp_with({"--origin", "nan,0,0"}), "origin"},
           {warp_with({"--direction", "1,0,0,1,0,0,0,0,1"}), "direction"}}) {
    expect_refused(scene, refused, 1);
  }
}

TEST(BadInput, ChecksPixelTypesAgainstOptions) {
  const Scene scene;
  const Volume wide = ramp_volume<std::int64_t>();
  write_volumes(scene / "wide.vtkhdf", {&wide});
  const Names warp_wide{"warp", "wide.vtkhdf", "mesh.vtkhdf", "-o", "out.vtkhdf"};

  expect_refused(scene, {warp_wide, "use the nearest filter"}, 1);

  Names with_nan = warp_wide;
  with_nan.insert(with_nan.end(), {"--filter", "nearest", "--background", "nan"});
  expect_refused(scene, {with_nan, "density: background: not a finite number"}, 1);
}

TEST(BadInput, RefusesLabelsThatAreNone) {
  const Scene scene;
  Volume halves = ramp_volume<float>();
  halves.samples<float>()[959] = 0.5F;
  write_volumes(scene / "volume.vtkhdf", {&halves});
  expect_refused(
      scene,
      {warp_with({"--filter", "labels", "--quiet"}), "density: holds 0.500000, which is no label"},
      1);

  Volume colors = make_volume(ramp_volume<float>().grid, PixelType::uint8, 3, "colors");
  write_volumes(scene / "volume.vtkhdf", {&colors});
  expect_refused(scene, {warp_with({"--filter", "labels"}), "components, labels have one"}, 1);
}

TEST(BadInput, RefusesAnExtraOutputWithTheNameOfAnArray) {
  const Scene scene;
  const Volume mask = ramp_volume<std::uint8_t>("tetwarp_mask");
  write_volumes(scene / "volume.vtkhdf", {&mask});

  expect_refused(scene, {warp_with({}), "no array to warp"}, 1);
  expect_refused(scene,
                 {warp_with({"--array", "tetwarp_mask", "--outputs", "mask"}), "has this name"}, 1);
}

TEST(BadInput, RefusesFieldsThatCannotBe) {
  const Scene scene;

  expect_refused(scene,
                 {warp_with({"--outputs", "forward", "--dims", "5,5,5"}), "leave out --grid"}, 1);
  expect_refused(scene,
                 {{"export", "volume.vtkhdf", "--axes", "lps", "-o", "field.nii"},
                  "--axes lps turns vectors (3)"},
                 1);
  write_text(scene / "mesh.msh", "Exit;");
  fs::remove(scene / "mesh.vtkhdf");
  expect_refused(scene, {{"import", "mesh.msh", "-o", "out.vtkhdf"}, "mesh.msh: "}, 1);
  expect_refused(scene,
                 {{"import", "absent.vtu", "-o", "out.vtkhdf"}, "absent.vtu: cannot be opened"}, 1);
}

TEST(BadInput, ReportsWhyCudaIsNotUsable) {
  const BackendStatus cuda = available_backends().front();
  if (cuda.usable) GTEST_SKIP() << "a CUDA device is usable: " << cuda.device;
  const Scene scene;

  expect_refused(scene, {warp_with({"--backend", "cuda"}), cuda.reason}, 1);
}

TEST(BadInput, RefusesATruncatedMesh) {
  const Scene scene;
  fs::resize_file(scene / "mesh.vtkhdf", fs::file_size(scene / "mesh.vtkhdf") / 2);

  expect_refused(scene, {warp_with({}), "mesh.vtkhdf"}, 1);
}
}  // namespace
}  // namespace tetwarp::test
