/// @file test_cli_bad_formats.cpp
/// Files of formats that are not read, damaged foreign meshes, options and batch files: one line
/// with file, dataset or key and remedy, nothing left behind.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/cli_scene.hpp"
#include "tests/support/foreign_meshes.hpp"
#include "tests/support/refused_line.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

/// A file and what the line about it must hold.
struct BadFile {
  std::string name;
  std::string text;
  std::string phrase;
};

TEST(BadFormats, AreNamedWithARemedy) {
  const Scene scene;
  for (const BadFile& bad : std::vector<BadFile>{
           {"a.nrrd", "NRRD0004\n", "a.nrrd: sizes: is missing in its header"},
           {"a.mha", "ObjectType = Image\n", "a.mha: ElementDataFile: is missing in its header"},
           {"a.mhd", "ObjectType = Image\n", "a.mhd: ElementDataFile: is missing in its header"},
           {"a.dcm", "ACR-NEMA", "a.dcm: is a DICOM file without 'DICM' at byte 128, which is not"},
           {"a.mgz", "\x1f\x8b?", "a.mgz: is a file without a header of FreeSurfer"},
           {"a.vti", "<?xml version=\"1.0\"?>\n", "a.vti: is a file without a VTK image (damaged"},
           {"a.pvti", "<?xml version=\"1.0\"?>\n", "a.pvti: is a VTK image in several files, whic"},
           {"a.vtkhdf", "", "a.vtkhdf: is empty, expected a volume; copy it again"},
           {"a.dat", "a letter",
            "a.dat: is a file of unknown kind, expected a volume; the order"}}) {
    write_text(scene / bad.name, bad.text);
    expect_refused_line(scene, {"warp", bad.name, "mesh.vtkhdf", "-o", "out.nii"}, bad.phrase);
  }
  for (const BadFile& bad : std::vector<BadFile>{
           {"b.pvtu", "<?xml", "b.pvtu: is a mesh in several files, which is not read; convert it"},
           {"b.xdmf", "<?xml",
            "b.xdmf: is a XDMF mesh, which is not read; convert it to .vtu, .vtk"},
           {"b.xmf", "<?xml", "b.xmf: is a XDMF mesh, which is not read; convert it to .vtu, .vtk"},
           {"b.inp", "*NODE\n", "b.inp: is a Abaqus mesh, which is not read; convert it to .vtu"},
           {"b.stl", "solid", "b.stl: is a surface, which is not read; make a mesh of tetrahedra"},
           {"b.vtkhdf", "", "b.vtkhdf: is empty, expected a mesh; copy it again"}}) {
    write_text(scene / bad.name, bad.text);
    expect_refused_line(scene, {"warp", "volume.vtkhdf", bad.name, "-o", "out.nii"}, bad.phrase);
  }
}

/// Replaces the first occurrence.
std::string with(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(BadFormats, MeshesThatContradictThemselves) {
  const Scene scene;
  const std::string good = legacy_vtk(box_mesh(), shifts({3})[0]);
  const std::string bare = legacy_vtk(box_mesh());
  const std::string gmsh = msh(box_mesh());
  write_text(scene / "good.vtk", good);
  write_text(scene / "good.msh", gmsh);
  const std::string missing = missing_readers(scene, {"good.vtk", "good.msh"});
  if (!missing.empty()) GTEST_SKIP() << missing;
  const std::string huge = line_of(Point3{1e300, 0, 0});
  const std::string nodes = gmsh.substr(0, gmsh.find("$Elements"));
  const std::string data = "$NodeData\n1\n\"displacement\"\n1\n0\n3\n0\n";
  for (const BadFile& bad : std::vector<BadFile>{
           {"a.vtk", with(good, "UNSTRUCTURED_GRID", "POLYDATA"), "a.vtk: holds no unstructured"},
           {"b.vtk", with(good, "4 0 3 5 6", "4 -1 3 5 6"),
            "b.vtk: cell 0 does not have the nodes"},
           {"c.vtk", with(bare, "CELLS 5 25", "CELLS 5 24"),
            "c.vtk: has 5 cells of 20 nodes, but declares 'CELLS 5 24': damaged, write it again"},
           {"d.vtk", with(bare, "CELLS 5 25", "CELLS 5 26"), "d.vtk: has 6 cells"},
           {"e.vtk", bare + "POINT_DATA 8\nFIELD f 1\ndisplacement 2 8 double\n" + huge + huge,
            "e.vtk: "},
           {"f.vtk", with(good, "6.000000 0.000000 0.000000\n", huge.substr(1)),
            "f.vtk: deformed positions: a node of tetrahedron 0 is not finite or over 2^40 voxels "
            "from the output grid; correct the positions, or check units and axes"},
           {"g.vtk", with(good, "28.000000", huge.substr(1, huge.find(' ', 1) - 1)),
            "g.vtk: mesh: rest position of node 1 is over 2^40 voxels from the source grid; corr"},
           {"h.vtu", "<html>not found</html>", "h.vtu: holds no unstructured grid that VTK can"},
           {"i.vtu", "<?xml version=\"1.0\"?><VTKFile type=\"ImageData\"></VTKFile>",
            "i.vtu: is no im"},
           {"j.msh", "$NOD\n1\n1 0 0 0\n$ENDNOD\n", "j.msh: does not begin with $MeshFormat, as G"},
           {"k.msh", with(gmsh, "2.2", "9.9"), "k.msh: Gmsh cannot read it: Unknown MSH file ver"},
           {"l.msh", nodes + "$Elements\n1\n1 4 2 1 1 1 2 3 99\n$EndElements\n",
            "l.msh: Gmsh cannot read it: Wrong node index 99"},
           {"m.msh", nodes + "$Elements\n1\n1 2 2 1 1 1 2 3\n$EndElements\n",
            "m.msh: holds no tetrahedron or hexahedron: damaged, or a surface mesh"},
           {"n.msh",
            nodes + "$Elements\n1\n1 12 2 1 1 1 2 3 4 5 6 7 8 1 2 3 4 5 6 7 8 1 2 3 4 5 6 7 8 1 2 "
                    "3\n$EndElements\n",
            "n.msh: cell 1 is a Hexahedron 27, expected tetrahedra of four or ten nodes"},
           {"o.msh", gmsh + data + "3\n2\n1 0 0 0\n2 0 0 0\n$EndNodeData\n",
            "o.msh: displacement: step 0 has no data of node 3, which cells have"},
           {"p.msh", gmsh + data + "1\n2\n1 0\n2 0\n$EndNodeData\n",
            "p.msh: displacement: step 0: expected three components for every node"}}) {
    write_text(scene / bad.name, bad.text);
    const Names words{"warp", "volume.vtkhdf", bad.name, "-o", "out.nii", "--quiet"};
    expect_refused_line(scene, words, bad.phrase);
  }
}

/// Usage errors have the exit code 2.
TEST(BadFormats, NumbersAndChoicesOfOptions) {
  const Scene scene;
  struct Case {
    Names words;
    std::string phrase;
    int exit_code;
  };
  const auto warp = [](Names more) {
    more.insert(more.begin(), {"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "out.nii"});
    return more;
  };
  for (const Case& bad : std::vector<Case>{
           {warp({"--background", "1e400"}), "--background: '1e400' is beyond the numbers of", 2},
           {warp({"--background", "-1e999"}), "--background: '-1e999' is beyond the numbers", 2},
           {warp({"--memory", "1e400"}), "--memory: '1e400' is not a size such as 512M or 4G", 2},
           {warp({"--intensity", "conservative", "--outside", "identity"}), "--outside: --inten",
            2},
           {warp({"--intensity", "density", "--outside", "nearest"}), "are for values, not for", 2},
           {warp({"--outside", "falloff"}), "--outside: falloff takes a distance, as in", 2},
           {warp({"--outside", "falloff:-3"}), "--outside: '-3' is not a distance above 0", 2},
           {warp({"--outside", "identity:3"}), "--outside: only falloff takes a distance", 2},
           {warp({"--outside", "nearest", "--memory", "1M"}), "nearest needs the whole mesh", 1},
           {warp({"--fsl", "absolut"}), "--fsl: 'absolut' is not one of relative, absolute", 2},
           {warp({"--fsl", "absolute"}), "mesh.vtkhdf: is no NIfTI image; --fsl is for warp", 1},
           {warp({"--spacing", "1e-9,1,1"}), "correct --grid, --dims, --origin, --spacing or -", 1},
           {warp({"--report", "/dev/full"}), "/dev/full: exists and is not a regular file", 1},
           {{"mesh", "volume.vtkhdf", "-o", "m.vtkhdf", "--threshold", "nan"},
            "--threshold: 'nan' is not a finite number (see tetwarp mesh --help)",
            2},
           {{"render", "volume.vtkhdf", "-o", "a.png", "--low", "inf"},
            "--low: 'inf' is not a finite number (see tetwarp render --help)",
            2},
           {{"view", "torso", "--skin-stiffness", "3"},
            "--skin-stiffness: needs --fingers (see tetwarp view --help)",
            2},
           {{"view", "--make-keys", "k", "--record", "r.txt"}, "--record: has no effect with", 2},
           {{"view", "--join", "tcp://a:1", "--screen", "left", "--steps", "3"},
            "--steps: has no effect with --join; leave it out",
            2},
           {{"view", "--join", "tcp://a:1", "--tracker", "--screenshot", "a.png"},
            "--screenshot: has no effect with --tracker",
            2},
           {{"view", "torso", "--join", "tcp://a:1", "--screen", "left"},
            "SCENE: has no effect with --join",
            2},
           {{"view", "top", "--devices", "gamepad,mesh.vtkhdf", "--record", "mesh.vtkhdf"},
            "mesh.vtkhdf: is also an input",
            1},
           {{"view", "top", "--screens", "mesh.vtkhdf", "--checkpoint", "mesh.vtkhdf"},
            "mesh.vtkhdf: is also an input",
            1},
           {{"view", "top", "--film", "a.png", "--screenshot", "a.png"},
            "would be written twice",
            1},
           {{"deform", "mesh.vtkhdf", "-o", "m.vtkhdf", "--kind", "translate", "--offset",
             "0,nan,0"},
            "--offset: expected finite numbers (see tetwarp deform --help)",
            2},
           {{"demo", "-o", "volume.vtkhdf"}, "volume.vtkhdf: is a file; name a folder", 1}}) {
    expect_refused_line(scene, bad.words, bad.phrase, {}, bad.exit_code);
  }
}

TEST(BadFormats, BatchFilesNameTheirKeys) {
  const Scene scene;
  const std::string job = R"({"jobs": [{"mesh": "mesh.vtkhdf", "output": "o.nii")";
  for (const BadFile& bad : std::vector<BadFile>{
           {"a.json", job + "}]}", "job 1: a.json: has no 'volume'"},
           {"b.json", job + R"(, "volume": 7}]})",
            "b.json: 'volume' holds 7, expected the name of a file"},
           {"c.json", job + R"(, "volume": "volume.vtkhdf", "treads": 2}]})",
            "c.json: unknown key 'treads'; keys are volume, mesh, transform and the options of "
            "tetwarp warp"},
           {"d.json", R"({"jobs": 3})", "d.json: expected {\"jobs\": [...]} with one job"}}) {
    write_text(scene / bad.name, bad.text);
    expect_refused_line(scene, {"warp", "--batch", bad.name, "--quiet"}, bad.phrase);
  }
}
}  // namespace
}  // namespace tetwarp::test
