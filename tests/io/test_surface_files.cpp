/// @file test_surface_files.cpp
/// Surfaces in the formats of other programs, and seams.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include <tetwarp/scene_io.hpp>
#include <tetwarp/surface_reader.hpp>

#include "io/reader/surface_seams.hpp"
#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
using Triangles = std::vector<std::array<std::int32_t, 3>>;

/// A unit cube of six squares, counter-clockwise from outside.
const std::vector<Point3> corners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                  {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
constexpr int squares[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                               {2, 3, 7, 6}, {1, 2, 6, 5}, {3, 0, 4, 7}};

Triangles cube() {
  Triangles triangles;
  for (const auto& s : squares) {
    triangles.push_back({s[0], s[1], s[2]});
    triangles.push_back({s[0], s[2], s[3]});
  }
  return triangles;
}

/// Edges that do not pass as often forward as back.
int open_edges(const Triangles& triangles) {
  std::map<std::pair<int, int>, int> passes;
  for (const auto& t : triangles) {
    for (std::size_t e = 0; e < 3; ++e) {
      const auto [low, high] = std::minmax(t[e], t[(e + 1) % 3]);
      passes[{low, high}] += t[e] == low ? 1 : -1;
    }
  }
  int open = 0;
  for (const auto& [edge, sum] : passes) open += sum != 0 ? 1 : 0;
  return open;
}

std::string number(double x) {
  return std::to_string(x) + " ";
}

std::string stl() {
  std::string text(80, 'x');
  const auto put = [&](const auto& value) {
    text.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  put(std::uint32_t{12});
  for (const auto& t : cube()) {
    for (int n = 0; n < 3; ++n) put(0.0F);
    for (const std::int32_t corner : t) {
      for (const double x : corners[static_cast<std::size_t>(corner)]) put(static_cast<float>(x));
    }
    put(std::uint16_t{0});
  }
  return text;
}

/// Each corner of a square has texture coordinates of its own.
std::string obj() {
  std::string text;
  for (const Point3& x : corners) text += "v " + number(x[0]) + number(x[1]) + number(x[2]) + "\n";
  for (int t = 0; t < 24; ++t) text += "vt " + number(t) + "0\n";
  for (int s = 0; s < 6; ++s) {
    text += "f";
    for (int c = 0; c < 4; ++c) {
      text += " " + std::to_string(squares[s][c] + 1) + "/" + std::to_string(4 * s + c + 1);
    }
    text += "\n";
  }
  return text;
}

std::string ply() {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
      "property float z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Point3& x : corners) text += number(x[0]) + number(x[1]) + number(x[2]) + "\n";
  for (const auto& s : squares) {
    text += "4";
    for (const int corner : s) text += " " + std::to_string(corner);
    text += "\n";
  }
  return text;
}

std::string legacy() {
  std::string text =
      "# vtk DataFile Version 3.0\ncube\nASCII\nDATASET POLYDATA\nPOINTS 24 double\n";
  for (const auto& s : squares) {
    for (const int corner : s) {
      const Point3& x = corners[static_cast<std::size_t>(corner)];
      text += number(x[0]) + number(x[1]) + number(x[2]);
    }
  }
  text += "\nPOLYGONS 6 30\n";
  for (int s = 0; s < 24; s += 4) {
    text += "4 " + std::to_string(s) + " " + std::to_string(s + 1) + " " + std::to_string(s + 2) +
            " " + std::to_string(s + 3) + "\n";
  }
  return text;
}

TEST(SurfaceFiles, OfAllFormatsGiveAClosedCube) {
  const ScratchFolder folder;
  for (const auto& [name, text] :
       {std::pair{"a.stl", stl()}, {"b.OBJ", obj()}, {"c.ply", ply()}, {"d.vtk", legacy()}}) {
    std::ofstream(folder / name, std::ios::binary) << text;
    Surface surface;
    const std::string error = io_error([&] { surface = read_surface(folder / name); });
    if (error.find("this build cannot read") != std::string::npos) GTEST_SKIP() << error;

    EXPECT_EQ(error, "");
    EXPECT_EQ(surface.points.size(), 8U) << name;
    EXPECT_EQ(surface.triangles.size(), 12U) << name;
    EXPECT_EQ(open_edges(surface.triangles), 0) << name;
    double volume = 0;
    for (const auto& t : surface.triangles) {
      const Point3 &a = surface.points[static_cast<std::size_t>(t[0])],
                   &b = surface.points[static_cast<std::size_t>(t[1])],
                   &c = surface.points[static_cast<std::size_t>(t[2])];
      volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                 a[2] * (b[0] * c[1] - b[1] * c[0])) /
                6;
    }
    EXPECT_NEAR(volume, 1, 1e-6) << name;
  }
}

/// A triangle. @param times  attribute of the grid @param array  name of a point array of vectors
std::string vtu(const std::string& times, const std::string& array) {
  return R"(<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
<UnstructuredGrid)" +
         times + R"(><Piece NumberOfPoints="3" NumberOfCells="1">
<PointData><DataArray type="Float64" NumberOfComponents="3" format="ascii" Name=")" +
         array + R"(">0 0 -5 0 0 -5 0 0 -5</DataArray></PointData>
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
0 0 0 1 0 0 0 1 0</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">0 1 2</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">3</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">5</DataArray></Cells>
</Piece></UnstructuredGrid></VTKFile>
)";
}

/// A proof about the points at rest would say nothing of the motion.
TEST(SurfaceFiles, WithAMotionThatIsNotReadAreRefusedByTheReader) {
  const ScratchFolder folder;
  const auto error_of = [&](const std::string& name, const std::string& text) {
    std::ofstream(folder / name, std::ios::binary) << text;
    return io_error([&] { const SurfaceReader reader(folder / name); });
  };
  const std::string at_rest = error_of("a.vtu", vtu("", "velocity"));
  if (at_rest.find("this build cannot read") != std::string::npos) GTEST_SKIP() << at_rest;

  EXPECT_EQ(at_rest, "");
  EXPECT_NE(error_of("b.vtu", vtu("", "displacement"))
                .find("displacement: is not read of this format; move the points by it"),
            std::string::npos);
  EXPECT_NE(error_of("c.vtu", vtu(R"( TimeValues="0 1 2")", "velocity")).find("has 3 steps"),
            std::string::npos);
  EXPECT_NE(error_of("d.pvd", "<VTKFile/>").find("is no file of a single surface"),
            std::string::npos);
}

/// Points are doubled along random edges; joined, the cube has its edges again, and its number of
/// points in use.
TEST(SurfaceFiles, SeamsAreJoined) {
  std::mt19937 random(7);
  for (int run = 0; run < 50; ++run) {
    std::vector<Point3> points = corners;
    Triangles triangles = cube();
    for (auto& t : triangles) {
      if (random() % 2 == 0) continue;
      for (std::int32_t& corner : t) {
        points.push_back(points[static_cast<std::size_t>(corner)]);
        corner = static_cast<std::int32_t>(points.size()) - 1;
      }
    }

    join_seams(points, triangles);

    EXPECT_EQ(open_edges(triangles), 0) << run;
    std::map<std::int32_t, int> used;
    for (const auto& t : triangles) {
      for (const std::int32_t corner : t) ++used[corner];
    }
    EXPECT_EQ(used.size(), 8U) << run;
  }
}

/// Two closed cubes in one place keep their points.
TEST(SurfaceFiles, ClosedSurfacesThatTouchStayApart) {
  std::vector<Point3> points = corners;
  points.insert(points.end(), corners.begin(), corners.end());
  Triangles both = cube();
  for (auto t : cube()) {
    for (std::int32_t& corner : t) corner += 8;
    both.push_back(t);
  }
  const Triangles before = both;

  join_seams(points, both);

  EXPECT_EQ(both, before);
}
}  // namespace
}  // namespace tetwarp::test
