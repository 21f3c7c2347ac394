/// @file test_cli_points.cpp
/// `tetwarp points`: every format of points keeps what it holds, in its own axes.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <tetwarp/io.hpp>
#include <tetwarp/scene_io.hpp>
#include <vector>

#include "tests/support/cli_scene.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

/// The scene's mesh moves by 6 along x in its last step.
class CliPoints : public ::testing::Test {
 protected:
  CommandResult move(const std::string& input, const std::string& output, Names more = {}) const {
    Names words{"points", input, "mesh.vtkhdf", "-o", output, "--steps", "3"};
    words.insert(words.end(), more.begin(), more.end());
    return run_command(scene, words);
  }
  std::string moved(const std::string& name,
                    const std::string& text,
                    const Names& more = {}) const {
    write_text(scene / name, text);
    const CommandResult result = move(name, "out_" + name, more);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return text_of(scene / ("out_" + name));
  }
  std::string refusal(const std::string& name, const std::string& text) const {
    write_text(scene / name, text);
    const CommandResult result = move(name, "out_" + name);
    EXPECT_EQ(result.exit_code, 1) << name;
    EXPECT_TRUE(result.has_one_line_error()) << result.err;
    EXPECT_FALSE(fs::exists(scene / ("out_" + name)));
    return result.err;
  }

  const Scene scene;
};

TEST_F(CliPoints, OfATableKeepItsColumnsLinesAndDigits) {
  EXPECT_EQ(moved("a.csv",
                  "# of a reader\r\nlabel,Z,y,x,note\r\n\"tip, left\",100.50,0,5,a\r\n"
                  "far,1e2,0,-5.10,\r\n\r\n"),
            "# of a reader\r\nlabel,Z,y,x,note,inside\r\n\"tip, left\",100.5,0,11,a,1\r\n"
            "far,1e2,0,-5.10,,0\r\n\r\n");
}

TEST_F(CliPoints, OfATableWithoutNamesAreItsFirstThreeColumns) {
  EXPECT_EQ(moved("a.csv", "5;0;100;7\n6;0;100;8"), "11;0;100;7;1\n12;0;100;8;1");
  EXPECT_EQ(moved("a.tsv", "5\t0\t100\n"), "11\t0\t100\t1\n");
}

TEST_F(CliPoints, GoBackByTheInverse) {
  const std::string there = moved("a.csv", "x,y,z\n5,0,100\n20,10.25,110\n");
  EXPECT_EQ(there, "x,y,z,inside\n11,0,100,1\n26,10.25,110,1\n");
  EXPECT_EQ(moved("b.csv", there, {"--inverse"}), "x,y,z,inside\n5,0,100,1\n20,10.25,110,1\n");
}

TEST_F(CliPoints, OutsideAreCountedOnStandardError) {
  write_text(scene / "a.csv", "x,y,z\n5,0,100\n5,0,0\nnan,0,100\n");
  const CommandResult result = move("a.csv", "out.csv", {"--quiet"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err,
            "tetwarp: out.csv: 2 of 3 points of a.csv are in no cell of the rest mesh and keep "
            "their place\n");
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(text_of(scene / "out.csv"), "x,y,z,inside\n11,0,100,1\n5,0,0,0\nnan,0,100,0\n");
}

/// Half a turn about z lies between RAS and LPS.
TEST_F(CliPoints, InLpsAreTurnedByOptionByColumnsOrByTheFile) {
  EXPECT_EQ(moved("a.csv", "x,y,z\n-5,-1,100\n", {"--axes", "lps"}),
            "x,y,z,inside\n-11,-1,100,1\n");
  EXPECT_EQ(moved("a.csv", "l,p,s\n-5,-1,100\n"), "l,p,s,inside\n-11,-1,100,1\n");
  EXPECT_EQ(moved("a.csv", "r,a,s\n5,1,100\n"), "r,a,s,inside\n11,1,100,1\n");
  const std::string columns =
      "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID";
  const std::string head = "# Markups fiducial file version = 4.11\n# CoordinateSystem = ";
  EXPECT_EQ(moved("a.fcsv", head + "LPS\n" + columns + "\n1,-5,-1,100,0,0,0,1,1,1,0,F-1,,,2,0\n"),
            head + "LPS\n" + columns + ",,,inside\n1,-11,-1,100,0,0,0,1,1,1,0,F-1,,,2,0,1\n");
  EXPECT_EQ(moved("a.fcsv", head + "0\n" + columns + "\n1,5,1,100,0,0,0,1,1,1,0,F-1,,\n"),
            head + "0\n" + columns + ",inside\n1,11,1,100,0,0,0,1,1,1,0,F-1,,,1\n");
  write_text(scene / "a.csv", "r,a,s\n5,1,100\n");
  const CommandResult result = move("a.csv", "out.csv", {"--axes", "lps"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("leave out --axes"), std::string::npos);
}

TEST_F(CliPoints, OfSlicersMarkupsKeepTheirKeys) {
  const auto point = [](double x, double y) {
    return nlohmann::json{{"id", "1"}, {"position", {x, y, 100.0}}, {"orientation", {-1, 0}}};
  };
  nlohmann::json undefined = point(0, 0);
  undefined["positionStatus"] = "undefined";
  const nlohmann::json file{
      {"@schema", "markups-schema-v1.0.3"},
      {"markups",
       {{{"type", "Curve"}, {"coordinateSystem", "LPS"}, {"controlPoints", {point(-5, -1)}}},
        {{"type", "Line"},
         {"coordinateSystem", "RAS"},
         {"controlPoints", {undefined, point(5, 1), point(-5, 1)}}}}}};

  const std::string text = moved("a.mrk.json", file.dump());

  nlohmann::json expected = file;
  auto& markups = expected["markups"];
  markups[0]["controlPoints"][0]["position"] = {-11.0, -1.0, 100.0};
  markups[0]["controlPoints"][0]["inside"] = 1;
  markups[1]["controlPoints"][1]["position"] = {11.0, 1.0, 100.0};
  markups[1]["controlPoints"][1]["inside"] = 1;
  markups[1]["controlPoints"][2]["inside"] = 0;
  EXPECT_EQ(nlohmann::json::parse(text), expected);
}

TEST_F(CliPoints, OfVtkhdfSurfacesKeepCellsAndArrays) {
  const std::vector<float> heat{1, 2, 3};
  const auto* const bytes = reinterpret_cast<const std::byte*>(heat.data());
  write_surface(scene / "s.vtkhdf", {{{5, 0, 100}, {6, 0, 100}, {-9, 0, 100}}, {{0, 1, 2}}},
                {{"heat", false, PixelType::float32, 1, {bytes, bytes + 12}}});

  ASSERT_EQ(move("s.vtkhdf", "out.vtkhdf").exit_code, 0);

  const Surface surface = read_surface(scene / "out.vtkhdf");
  EXPECT_EQ(surface.points, (std::vector<Point3>{{11, 0, 100}, {12, 0, 100}, {-9, 0, 100}}));
  EXPECT_EQ(surface.triangles.size(), 1u);
  std::vector<std::string> left_out;
  read_surface(scene / "out.vtkhdf", &left_out);
  EXPECT_EQ(left_out, (Names{"PointData/heat", "PointData/inside"}));
  const CommandResult again = run_command(
      scene, {"points", "out.vtkhdf", "mesh.vtkhdf", "-o", "again.vtkhdf", "--steps", "1"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
}

TEST_F(CliPoints, OfSeveralStepsAreAFileEach) {
  write_text(
      scene / "a.mrk.json",
      R"({"markups": [{"coordinateSystem": "RAS", "controlPoints": [{"position": [5, 0, 100]}]}]})");
  const CommandResult result = run_command(
      scene, {"points", "a.mrk.json", "mesh.vtkhdf", "-o", "m.mrk.json", "--steps", "1:"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const Names names = scene.names();
  for (const char* name : {"m_0001.mrk.json", "m_0002.mrk.json", "m_0003.mrk.json"}) {
    EXPECT_NE(std::find(names.begin(), names.end(), name), names.end()) << name;
  }
}

TEST_F(CliPoints, HaveTheOwnersOfAWarpWithItsGrid) {
  write_text(scene / "a.csv", "4,-4,99\n28,16,115\n");
  const CommandResult result = move("a.csv", "out.csv", {"--like", "volume.vtkhdf"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(text_of(scene / "out.csv"), "10,-4,99,1\n34,16,115,1\n");
}

TEST_F(CliPoints, OfBadFilesAreRefusedInOneLine) {
  EXPECT_NE(refusal("a.csv", "x,y,z\n1,2\n").find("line 2: has 2 columns"), std::string::npos);
  EXPECT_NE(refusal("a.csv", "x;y;z\n1,5;2;3\n").find("'1,5' is no number"), std::string::npos);
  EXPECT_NE(refusal("a.csv", "a,b,c\n1,2,3\n").find("line 1"), std::string::npos);
  EXPECT_NE(refusal("a.csv", "x,y,z\n").find("holds no point"), std::string::npos);
  EXPECT_NE(refusal("a.csv", "").find("holds no point"), std::string::npos);
  EXPECT_NE(refusal("a.fcsv", "# CoordinateSystem = IJK\n1,1,1,1\n").find("expected RAS or LPS"),
            std::string::npos);
  EXPECT_NE(refusal("a.fcsv", "1,1,1\n").find("lacks columns"), std::string::npos);
  EXPECT_NE(refusal("a.mrk.json", "{").find("is no JSON"), std::string::npos);
  EXPECT_NE(refusal("a.mrk.json", "[1]").find("holds no markups"), std::string::npos);
  EXPECT_NE(refusal("a.mrk.json", R"({"markups": [{"controlPoints": [{"position": [1, 2]}]}]})")
                .find("markups[0].controlPoints[0]"),
            std::string::npos);
  EXPECT_NE(
      refusal("a.mrk.json", R"({"markups": [{"coordinateSystem": "IJK", "controlPoints": [{}]}]})")
          .find("neither the coordinateSystem RAS nor LPS"),
      std::string::npos);
  EXPECT_NE(refusal("a.xyz", "1 2 3\n").find("must end in"), std::string::npos);
  write_text(scene / "a.csv", "1,2,3\n");
  EXPECT_NE(move("a.csv", "out.fcsv").err.find("ends in .csv, .tsv, .txt"), std::string::npos);
  EXPECT_NE(move("none.csv", "out.csv").err.find("cannot be opened"), std::string::npos);
  EXPECT_NE(move("mesh.vtkhdf", "out.vtkhdf").err.find("has steps"), std::string::npos);
  EXPECT_NE(move("volume.vtkhdf", "out.vtkhdf").err.find("expected UnstructuredGrid or PolyData"),
            std::string::npos);
  EXPECT_NE(move("a.csv", "a.csv").err.find("is also an input"), std::string::npos);
  const CommandResult order =
      run_command(scene, {"points", "mesh.vtkhdf", "a.csv", "-o", "out.vtkhdf"});
  EXPECT_NE(order.err.find("the order is: tetwarp points FILE MESH -o FILE"), std::string::npos);
}

/// A triangle in each format that VTK reads; formats of surfaces have no place for `inside`.
TEST_F(CliPoints, OfVtksFilesKeepCells) {
  write_text(scene / "a.stl",
             "solid a\nfacet normal 0 0 1\nouter loop\nvertex 5 0 100\nvertex 6 0 100\nvertex 5 1 "
             "100\nendloop\nendfacet\nendsolid a\n");
  write_text(scene / "a.obj", "v 5 0 100\nv 6 0 100\nv 5 1 100\nf 1 2 3\n");
  write_text(
      scene / "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
      "float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n5 0 "
      "100\n6 0 100\n5 1 100\n3 0 1 2\n");
  write_text(
      scene / "a.vtk",
      "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\nPOINTS 4 double\n5 0 100  6 0 "
      "100  5 1 100  7 1 100\nPOLYGONS 1 4\n3 0 1 2\nLINES 1 3\n2 2 3\nPOINT_DATA 4\nSCALARS "
      "heat float 1\nLOOKUP_TABLE default\n1 2 3 4\n");
  const std::string missing = move("a.stl", "b.stl").err;
  if (missing.find("this build cannot read") != std::string::npos) GTEST_SKIP() << missing;
  const std::vector<Point3> expected{{11, 0, 100}, {12, 0, 100}, {11, 1, 100}};
  for (const auto& [input, output] :
       std::vector<std::pair<std::string, std::string>>{{"a.stl", "b.stl"},
                                                        {"a.obj", "b.obj"},
                                                        {"a.ply", "b.ply"},
                                                        {"a.stl", "b.vtp"},
                                                        {"a.ply", "c.vtk"}}) {
    const CommandResult result = move(input, output);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(read_surface(scene / output).points, expected) << input << " " << output;
    const bool has_arrays = output.ends_with("vtp") || output.ends_with("vtk");
    EXPECT_EQ(result.err.find("no place for the array inside") == std::string::npos, has_arrays);
  }

  ASSERT_EQ(move("a.vtk", "b.vtk").exit_code, 0);
  const std::string text = text_of(scene / "b.vtk");
  for (const char* word : {"LINES", "heat", "inside", "POINTS 4 double"}) {
    EXPECT_NE(text.find(word), std::string::npos) << word;
  }
  write_text(scene / "bad.stl", "solid a\nfacet");
  const CommandResult bad = move("bad.stl", "out.stl");
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_TRUE(bad.has_one_line_error()) << bad.err;
  EXPECT_FALSE(fs::exists(scene / "out.stl"));
}

}  // namespace
}  // namespace tetwarp::test
