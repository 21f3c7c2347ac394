/// @file test_scene_files.cpp
/// Volumes and meshes that scene files name.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <tetwarp/io.hpp>
#include <tetwarp/simulate.hpp>
#include <variant>

#include "tests/scene/scene_texts.hpp"
#include "tests/support/foreign_meshes.hpp"
#include "tests/support/io_files.hpp"
#include "tests/support/message_of.hpp"

namespace tetwarp::test {
namespace {
using Mode = Hdf5Editor::Mode;

/// A tetrahedron's four triangles, and a fifth point that no triangle has.
void write_triangles(const std::string& path, std::uint8_t type = 5) {
  Hdf5Editor(path, Mode::create)
      .group("VTKHDF")
      .text("VTKHDF", "Type", "UnstructuredGrid")
      .dataset<std::int64_t>("VTKHDF/NumberOfPoints", {1}, {5})
      .dataset<std::int64_t>("VTKHDF/NumberOfCells", {1}, {4})
      .dataset<std::int64_t>("VTKHDF/NumberOfConnectivityIds", {1}, {12})
      .dataset<double>("VTKHDF/Points", {5, 3}, {0, 0, 0, 9, 9, 9, 1, 0, 0, 0, 1, 0, 0, 0, 1})
      .dataset<std::int64_t>("VTKHDF/Connectivity", {12}, {0, 3, 2, 0, 2, 4, 0, 4, 3, 2, 3, 4})
      .dataset<std::int64_t>("VTKHDF/Offsets", {5}, {0, 3, 6, 9, 12})
      .dataset<std::uint8_t>("VTKHDF/Types", {4}, {type, type, type, type});
}

/// A scene of one body in the folder, whose other keys are given.
std::string write_scene(const ScratchFolder& folder, const std::string& keys) {
  std::string file = folder / "scene.json";
  std::ofstream(file) << R"({"tetwarp_scene": 1, "time_step": 0.01, "duration": 1,
    "bodies": [{"name": "b", )"
                      << keys << "}]}";
  return file;
}

constexpr const char* solid_keys =
    R"("kind": "fem", "material": {"E": 1e5, "nu": 0.3, "density": 1000})";

TEST(SceneFiles, VolumesAreReadFromTheSceneFolder) {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "data");
  const Volume volume = counting_volume(PixelType::int16, 1, "ct");
  const Volume other = counting_volume(PixelType::uint8, 1, "labels");
  write_volumes(folder / "data/v.vtkhdf", {&volume, &other});
  write_nifti(folder / "v.nii.gz", volume);
  for (const std::string& name :
       {std::string(R"("data/v.vtkhdf", "array": "ct")"), std::string(R"("v.nii.gz")")}) {
    const Scene scene = read_scene(write_scene(folder, std::string(solid_keys) +
                                                           R"(, "lattice": {"tets": 9}, "volume":
          {"threshold": 7, "file": )" + name + "}"));
    const auto& image = std::get<ImageGeometry>(scene.bodies.at(0).geometry);
    EXPECT_EQ(image.volume.data, volume.data) << name;
    EXPECT_EQ(image.threshold, 7);
  }
}

TEST(SceneFiles, AnErrorInAFileNamesSceneKeyAndFile) {
  const ScratchFolder folder;
  const Volume volume = counting_volume(PixelType::int16, 1, "ct");
  write_volumes(folder / "v.vtkhdf", {&volume});
  const std::string scene =
      write_scene(folder, std::string(solid_keys) +
                              R"(, "lattice": {"tets": 9}, "volume": {"threshold": 7, "array": "mr",
                  "file": "v.vtkhdf"})");
  const std::string message = io_error([&] { read_scene(scene); });
  EXPECT_TRUE(message.starts_with(scene + ": bodies[0].volume.file: " + (folder / "v.vtkhdf")))
      << message;
  EXPECT_TRUE(io_error([&] { read_scene(folder / "no.json"); }).starts_with(folder / "no.json"));
  EXPECT_NE(io_error([&] { read_scene(folder / ""); }), "") << "a folder";
}

TEST(SceneFiles, MeshesOfTetrahedraAndTriangles) {
  const ScratchFolder folder;
  write_mesh(folder / "tets.vtkhdf", two_tets());
  write_triangles(folder / "triangles.vtkhdf");
  const auto body_of = [&](const std::string& keys, const std::string& mesh) {
    const Scene scene =
        read_scene(write_scene(folder, keys + R"(, "mesh": {"file": ")" + mesh + "\"}"));
    return scene.bodies.at(0).geometry;
  };
  EXPECT_EQ(std::get<Mesh>(body_of(solid_keys, "tets.vtkhdf")).tets, two_tets().tets);
  const std::string rigid = R"("kind": "rigid", "density": 1)";
  const std::string scripted = R"("kind": "scripted")";
  for (const std::string& keys : {rigid, scripted}) {
    const auto surface = std::get<Surface>(body_of(keys, "triangles.vtkhdf"));
    EXPECT_EQ(surface.points.size(), 4u) << "the point without triangles is left out";
    EXPECT_EQ(surface.points[1], (Point3{1, 0, 0}));
    EXPECT_EQ(surface.triangles.at(3), (std::array<std::int32_t, 3>{1, 2, 3}));
  }
  EXPECT_TRUE(std::holds_alternative<Mesh>(body_of(scripted, "tets.vtkhdf")));
  const std::string message = io_error([&] { body_of(rigid, "tets.vtkhdf"); });
  EXPECT_NE(message.find("holds no triangle (5, VTK_TRIANGLE) at step 0; extract the surface"),
            std::string::npos)
      << message;
  EXPECT_NE(io_error([&] { body_of(solid_keys, "triangles.vtkhdf"); }), "");
}

/// Cells that are there twice are read once, and noted; a back of a cloth's triangle is refused.
TEST(SceneFiles, CellsThatAreThereTwiceCountOnce) {
  const ScratchFolder folder;
  Mesh mesh = two_tets();
  mesh.tets.push_back({3, 2, 0, 1});
  write_mesh(folder / "tets.vtkhdf", mesh);
  const Surface triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {1, 3, 2}}};
  Surface turned = triangle, back = triangle;
  turned.triangles.push_back({2, 0, 1});
  back.triangles.push_back({1, 0, 2});
  write_surface(folder / "turned.vtkhdf", turned);
  write_surface(folder / "back.vtkhdf", back);
  const auto scene_of = [&](const std::string& keys, const std::string& name) {
    return read_scene(write_scene(folder, keys + R"(, "mesh": {"file": ")" + name + "\"}"));
  };
  const std::string cloth = R"("kind": "cloth", "areal_density": 1, "stretch": 10)";

  const Scene solid = scene_of(solid_keys, "tets.vtkhdf"), sheet = scene_of(cloth, "turned.vtkhdf");

  EXPECT_EQ(std::get<Mesh>(solid.bodies[0].geometry).tets, two_tets().tets);
  EXPECT_EQ(solid.notes,
            std::vector<std::string>{(folder / "tets.vtkhdf") +
                                     ": 1 of 3 cells are there twice and were merged"});
  EXPECT_EQ(std::get<Surface>(sheet.bodies[0].geometry).triangles, triangle.triangles);
  EXPECT_EQ(sheet.notes.size(), 1u);
  const Scene both = scene_of(cloth, "back.vtkhdf");
  EXPECT_TRUE(both.notes.empty());
  const std::string message = message_of([&] { Simulator simulator(both); });
  EXPECT_EQ(message,
            "bodies[0].mesh: triangles 0 and 2 are the same and would count twice, remove one of "
            "them");
}

/// What is found out once files are read names its place once.
TEST(SceneFiles, SurfacesThatDoNotFitNameTheirPlaceOnce) {
  const ScratchFolder folder;
  const std::string solid =
      std::string(solid_keys) + R"(, "lattice": {"edge": 1}, "mesh": {"file": "s.vtkhdf"})";
  Surface surface{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                  {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  const auto message_with = [&](const std::string& keys) {
    write_surface(folder / "s.vtkhdf", surface);
    const std::string scene = write_scene(folder, solid + keys);
    const std::string message = io_error([&] { read_scene(scene); });
    EXPECT_TRUE(message.starts_with(scene + ": ")) << message;
    return message.substr(std::min(message.size(), scene.size() + 2));
  };
  EXPECT_TRUE(message_with(R"(, "surface": {"distance": 0.9})")
                  .starts_with("bodies[0].surface.distance: is too coarse: expected at most"));
  const std::size_t count = surface.points.size();
  for (std::size_t p = 0; p < count; ++p) {
    const auto [x, y, z] = surface.points[p];
    surface.points.push_back({x + 0.1, y + 0.1, z + 0.1});
  }
  for (std::size_t t = 0; t < 4; ++t) {
    const auto [a, b, c] = surface.triangles[t];
    surface.triangles.push_back({a + 4, b + 4, c + 4});
  }
  EXPECT_TRUE(message_with("").starts_with(
      "bodies[0].mesh.file: the surface intersects itself, in triangles "));
}

TEST(SceneFiles, SurfacesAndObstaclesAreTriangles) {
  const ScratchFolder folder;
  write_triangles(folder / "t.vtkhdf");
  const Scene scene = read_scene(write_scene(
      folder,
      std::string(solid_keys) + R"(, "lattice": {"edge": 1}, "surface": {"mesh": "t.vtkhdf"},
      "shape": {"type": "box", "half": [1, 1, 1]}}], "obstacles": [{"mesh": {"file": "t.vtkhdf"})"));
  EXPECT_EQ(std::get<Surface>(scene.bodies.at(0).surface).triangles.size(), 4u);
  EXPECT_EQ(std::get<Surface>(scene.obstacles.at(0).geometry).triangles.size(), 4u);
}

TEST(ReadSurface, TakesTheTrianglesOfVtkAndGmshFiles) {
  const ScratchFolder folder;
  const std::string points = "0 0 0  1 0 0  0 1 0  0 0 1  1 1 1";
  std::ofstream(folder / "m.vtk")
      << "# vtk DataFile Version 3.0\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n"
      << points << "\nCELLS 3 13\n3 1 2 3\n4 0 1 2 3\n3 1 3 2\nCELL_TYPES 3\n5\n10\n5\n";
  std::ofstream(folder / "m.msh")
      << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"
      << "$EndNodes\n$Elements\n3\n1 1 2 1 1 1 2\n2 2 2 1 1 2 3 4\n3 2 2 1 1 2 4 3\n"
      << "$EndElements\n";
  for (const std::string name : {"m.vtk", "m.msh"}) {
    Surface surface;
    const std::string message = io_error([&] { surface = read_surface(folder / name); });
    if (message.find("this build cannot read") != std::string::npos) continue;
    ASSERT_EQ(message, "") << name;
    EXPECT_EQ(surface.points, (std::vector<Point3>{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}})) << name;
    EXPECT_EQ(surface.triangles.at(0), (std::array<std::int32_t, 3>{0, 1, 2}));
    EXPECT_EQ(surface.triangles.at(1), (std::array<std::int32_t, 3>{0, 2, 1}));
  }
  std::ofstream(folder / "tets.vtk") << legacy_vtk(two_tets());
  EXPECT_NE(io_error([&] { read_surface(folder / "tets.vtk"); }), "");
}

TEST(ReadSurface, RefusesOtherCellsAndDamagedFiles) {
  const ScratchFolder folder;
  write_triangles(folder / "q.vtkhdf", 9);
  EXPECT_NE(io_error([&] { read_surface(folder / "q.vtkhdf"); }).find("9 (VTK_QUAD), expected"),
            std::string::npos);
  write_triangles(folder / "t.vtkhdf");
  Hdf5Editor(folder / "t.vtkhdf")
      .dataset<std::int64_t>("VTKHDF/Connectivity", {12}, {0, 3, 2, 0, 2, 4, 0, 4, 3, 2, 3, 5});
  EXPECT_NE(io_error([&] { read_surface(folder / "t.vtkhdf"); }).find("refers to node 5"),
            std::string::npos);
  EXPECT_NE(io_error([&] { read_surface(folder / "no.vtkhdf"); }), "");
}
}  // namespace
}  // namespace tetwarp::test
