#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>

#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
using Mode = Hdf5Editor::Mode;
using Integers = std::vector<std::int64_t>;

/// Points of two_tets() moved along x, in the type of a foreign file.
std::vector<float> moved_points(const std::vector<double>& offsets) {
  std::vector<float> values;
  for (const double x : offsets) {
    for (const Point3& point : two_tets().rest_positions) {
      values.push_back(static_cast<float>(point[0] + x));
      values.push_back(static_cast<float>(point[1]));
      values.push_back(static_cast<float>(point[2]));
    }
  }
  return values;
}

/// two_tets() with moving float32 points, offsets in columns [n][1], one topology for all steps.
void write_moving(const std::string& path, const std::vector<double>& offsets) {
  const hsize_t steps = offsets.size();
  const Integers zeros(steps, 0);
  Integers rows;
  for (std::size_t step = 0; step < steps; ++step) {
    rows.push_back(static_cast<std::int64_t>(5 * step));
  }
  Hdf5Editor(path, Mode::create)
      .group("VTKHDF")
      .text("VTKHDF", "Type", "UnstructuredGrid")
      .dataset<std::int64_t>("VTKHDF/NumberOfPoints", {1}, {5})
      .dataset<std::int64_t>("VTKHDF/NumberOfCells", {1}, {2})
      .dataset<std::int64_t>("VTKHDF/NumberOfConnectivityIds", {1}, {8})
      .dataset("VTKHDF/Points", {5 * steps, 3}, moved_points(offsets))
      .dataset<std::int32_t>("VTKHDF/Connectivity", {8}, {0, 1, 2, 3, 1, 2, 3, 4})
      .dataset<std::int32_t>("VTKHDF/Offsets", {3}, {0, 4, 8})
      .dataset<std::uint8_t>("VTKHDF/Types", {2}, {10, 10})
      .group("VTKHDF/Steps")
      .attribute<std::int64_t>("VTKHDF/Steps", "NSteps", {static_cast<std::int64_t>(steps)})
      .dataset("VTKHDF/Steps/Values", {steps}, offsets)
      .dataset("VTKHDF/Steps/PartOffsets", {steps}, zeros)
      .dataset("VTKHDF/Steps/NumberOfParts", {steps}, Integers(steps, 1))
      .dataset("VTKHDF/Steps/PointOffsets", {steps}, rows)
      .dataset("VTKHDF/Steps/CellOffsets", {steps, 1}, zeros)
      .dataset("VTKHDF/Steps/ConnectivityIdOffsets", {steps}, zeros);
}

/// Two parts of one tetrahedron each, as a parallel program writes them.
void write_parts(const std::string& path) {
  Hdf5Editor(path, Mode::create)
      .group("VTKHDF")
      .text("VTKHDF", "Type", "UnstructuredGrid")
      .dataset<std::int64_t>("VTKHDF/NumberOfPoints", {2}, {4, 5})
      .dataset<std::int64_t>("VTKHDF/NumberOfCells", {2}, {1, 1})
      .dataset<std::int64_t>("VTKHDF/NumberOfConnectivityIds", {2}, {4, 4})
      .dataset<double>("VTKHDF/Points", {9, 3}, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 5, 5,
                                                 5, 6, 5, 5, 5, 6, 5, 5, 5, 6, 7, 7, 7})
      .dataset<std::int64_t>("VTKHDF/Connectivity", {8}, {0, 1, 2, 3, 1, 2, 3, 4})
      .dataset<std::int64_t>("VTKHDF/Offsets", {4}, {0, 4, 0, 4})
      .dataset<std::uint8_t>("VTKHDF/Types", {2}, {10, 10});
}

/// A tetrahedron, and in the second part its ghost copy before another.
void write_ghost_parts(const std::string& path) {
  Hdf5Editor(path, Mode::create)
      .group("VTKHDF")
      .text("VTKHDF", "Type", "UnstructuredGrid")
      .dataset<std::int64_t>("VTKHDF/NumberOfPoints", {2}, {4, 5})
      .dataset<std::int64_t>("VTKHDF/NumberOfCells", {2}, {1, 2})
      .dataset<std::int64_t>("VTKHDF/NumberOfConnectivityIds", {2}, {4, 8})
      .dataset<double>("VTKHDF/Points", {9, 3}, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1,
                                                 1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, 0})
      .dataset<std::int64_t>("VTKHDF/Connectivity", {12}, {0, 1, 2, 3, 1, 2, 3, 4, 0, 1, 2, 3})
      .dataset<std::int64_t>("VTKHDF/Offsets", {5}, {0, 4, 0, 4, 8})
      .dataset<std::uint8_t>("VTKHDF/Types", {3}, {10, 10, 10});
}

TEST(VtkhdfMesh, CellsThatAreThereTwiceAreReadOnce) {
  const ScratchFolder folder;
  write_ghost_parts(folder / "m.vtkhdf");

  const MeshReader reader(folder / "m.vtkhdf");

  using Tets = std::vector<std::array<std::int32_t, 4>>;
  EXPECT_EQ(reader.mesh().tets, (Tets{{0, 1, 2, 3}, {4, 5, 6, 7}}));
  EXPECT_EQ(reader.header().tet_count, 2);
  EXPECT_EQ(reader.header().merged, "1 of 3 cells are there twice and were merged");
  EXPECT_EQ(reader.read_step(0).size(), 9u);
}

/// Steps whose cells are stored anew are compared with those of the rest step as stored.
TEST(VtkhdfMesh, CellsThatAreThereTwiceMayMove) {
  const ScratchFolder folder;
  write_moving(folder / "m.vtkhdf", {0, 2});
  Hdf5Editor(folder / "m.vtkhdf")
      .dataset<std::int32_t>("VTKHDF/Connectivity", {16},
                             {0, 1, 2, 3, 3, 2, 1, 0, 0, 1, 2, 3, 3, 2, 1, 0})
      .dataset<std::int32_t>("VTKHDF/Offsets", {6}, {0, 4, 8, 0, 4, 8})
      .dataset<std::uint8_t>("VTKHDF/Types", {4}, {10, 10, 10, 10})
      .dataset<std::int64_t>("VTKHDF/NumberOfPoints", {2}, {5, 5})
      .dataset<std::int64_t>("VTKHDF/NumberOfCells", {2}, {2, 2})
      .dataset<std::int64_t>("VTKHDF/NumberOfConnectivityIds", {2}, {8, 8})
      .dataset<std::int64_t>("VTKHDF/Steps/PartOffsets", {2}, {0, 1})
      .dataset<std::int64_t>("VTKHDF/Steps/CellOffsets", {2, 1}, {0, 2})
      .dataset<std::int64_t>("VTKHDF/Steps/ConnectivityIdOffsets", {2}, {0, 8});

  const MeshReader reader(folder / "m.vtkhdf");

  EXPECT_EQ(reader.mesh().tets.size(), 1u);
  EXPECT_EQ(reader.read_step(1)[0], (Point3{2, 0, 0}));
}

TEST(VtkhdfMesh, RoundTripsAStaticMesh) {
  const ScratchFolder folder;
  write_mesh(folder / "m.vtkhdf", two_tets());

  const MeshReader reader(folder / "m.vtkhdf");

  EXPECT_EQ(reader.header().node_count, 5);
  EXPECT_EQ(reader.header().tet_count, 2);
  EXPECT_EQ(reader.header().times, std::vector<double>{0});
  EXPECT_FALSE(reader.header().has_displacement);
  EXPECT_EQ(reader.mesh().tets, two_tets().tets);
  EXPECT_EQ(reader.mesh().rest_positions, two_tets().rest_positions);
  EXPECT_EQ(reader.read_step(0), two_tets().rest_positions);
}

TEST(VtkhdfMesh, RoundTripsDisplacementsOverSteps) {
  const ScratchFolder folder;
  write_mesh(folder / "m.vtkhdf", two_tets(), slides({0, 0.25, 4}), {1, 2, 5});

  const MeshReader reader(folder / "m.vtkhdf");

  EXPECT_TRUE(reader.header().has_displacement);
  EXPECT_EQ(reader.header().times, (std::vector<double>{1, 2, 5}));
  EXPECT_EQ(reader.read_step(0), two_tets().rest_positions);
  EXPECT_EQ(reader.read_step(1)[4], (Point3{1.25, 1, 1}));
  EXPECT_EQ(reader.read_step(2)[0], (Point3{4, 0, 0}));
}

TEST(VtkhdfMesh, NumbersStepsWithoutTimes) {
  const ScratchFolder folder;
  write_mesh(folder / "m.vtkhdf", two_tets(), slides({1, 2}));

  EXPECT_EQ(MeshReader(folder / "m.vtkhdf").header().times, (std::vector<double>{0, 1}));
}

TEST(VtkhdfMesh, AddsAStaticDisplacementAsTheOnlyStep) {
  const ScratchFolder folder;
  write_mesh(folder / "m.vtkhdf", two_tets());
  std::vector<float> shift(15, 0.5F);
  Hdf5Editor(folder / "m.vtkhdf").dataset("VTKHDF/PointData/displacement", {5, 3}, shift);

  const MeshReader reader(folder / "m.vtkhdf");

  EXPECT_EQ(reader.header().times.size(), 1U);
  EXPECT_EQ(reader.read_step(0)[0], (Point3{0.5, 0.5, 0.5}));
}

TEST(VtkhdfMesh, ReadsPointsThatMoveWithAnyRestStep) {
  const ScratchFolder folder;
  write_moving(folder / "m.vtkhdf", {0, 1, 3});

  const MeshReader reader(folder / "m.vtkhdf", {.rest_step = 1, .rest_file = {}});

  EXPECT_EQ(reader.mesh().rest_positions[0], (Point3{1, 0, 0}));
  EXPECT_EQ(reader.read_step(0)[0], (Point3{0, 0, 0}));
  EXPECT_EQ(reader.read_step(2)[4], (Point3{4, 1, 1}));
}

TEST(VtkhdfMesh, ReadsRepeatedPointOffsetsAsStepsThatStandStill) {
  const ScratchFolder folder;
  write_moving(folder / "m.vtkhdf", {0, 1, 3});
  Hdf5Editor(folder / "m.vtkhdf")
      .dataset<std::int64_t>("VTKHDF/Steps/PointOffsets", {3}, {0, 5, 5});

  const MeshReader reader(folder / "m.vtkhdf");

  EXPECT_EQ(reader.read_step(2), reader.read_step(1));
}

TEST(VtkhdfMesh, TakesRestFromAnotherFile) {
  const ScratchFolder folder;
  write_mesh(folder / "rest.vtkhdf", two_tets());
  write_moving(folder / "m.vtkhdf", {2});

  const MeshReader reader(folder / "m.vtkhdf",
                          {.rest_step = 0, .rest_file = folder / "rest.vtkhdf"});

  EXPECT_EQ(reader.mesh().rest_positions, two_tets().rest_positions);
  EXPECT_EQ(reader.read_step(0)[0], (Point3{2, 0, 0}));
}

TEST(VtkhdfMesh, RefusesRestStepsThatARestFileDoesNotHave) {
  const ScratchFolder folder;
  write_mesh(folder / "still.vtkhdf", two_tets());
  write_moving(folder / "m.vtkhdf", {0, 1, 3});

  for (const std::int64_t step : {std::numeric_limits<std::int64_t>::min(), std::int64_t{-1},
                                  std::int64_t{3}, std::numeric_limits<std::int64_t>::max()}) {
    const auto error = [&](const MeshReadOptions& options) {
      return io_error([&] { MeshReader(folder / "m.vtkhdf", options); });
    };
    const std::string no_step = "has no step " + std::to_string(step);
    EXPECT_NE(error({.rest_step = step}).find(no_step), std::string::npos);
    EXPECT_NE(error({.rest_step = step, .rest_file = folder / "m.vtkhdf"}).find(no_step),
              std::string::npos);
    EXPECT_NE(error({.rest_step = step, .rest_file = folder / "still.vtkhdf"}).find("do not move"),
              std::string::npos);
  }
}

TEST(VtkhdfMesh, ConcatenatesParts) {
  const ScratchFolder folder;
  write_parts(folder / "m.vtkhdf");

  const MeshReader reader(folder / "m.vtkhdf");

  EXPECT_EQ(reader.header().node_count, 9);
  EXPECT_EQ(reader.mesh().tets,
            (std::vector<std::array<std::int32_t, 4>>{{0, 1, 2, 3}, {5, 6, 7, 8}}));
  EXPECT_EQ(reader.mesh().rest_positions[8], (Point3{7, 7, 7}));
}

/// The second step is the second part alone: its rows in Offsets begin one later per part before.
TEST(VtkhdfMesh, FollowsPartOffsetsInTime) {
  const ScratchFolder folder;
  write_parts(folder / "m.vtkhdf");
  Hdf5Editor(folder / "m.vtkhdf")
      .dataset<std::int64_t>("VTKHDF/NumberOfPoints", {2}, {4, 4})
      .dataset<std::int64_t>("VTKHDF/Connectivity", {8}, {0, 1, 2, 3, 0, 1, 2, 3})
      .group("VTKHDF/Steps")
      .attribute<std::int64_t>("VTKHDF/Steps", "NSteps", {2})
      .dataset<double>("VTKHDF/Steps/Values", {2}, {0, 1})
      .dataset<std::int64_t>("VTKHDF/Steps/NumberOfParts", {2}, {1, 1})
      .dataset<std::int64_t>("VTKHDF/Steps/PartOffsets", {2}, {0, 1})
      .dataset<std::int64_t>("VTKHDF/Steps/PointOffsets", {2}, {0, 4})
      .dataset<std::int64_t>("VTKHDF/Steps/CellOffsets", {2, 1}, {0, 1})
      .dataset<std::int64_t>("VTKHDF/Steps/ConnectivityIdOffsets", {2, 1}, {0, 4});

  const MeshReader reader(folder / "m.vtkhdf");

  EXPECT_EQ(reader.header().node_count, 4);
  EXPECT_EQ(reader.read_step(1)[0], (Point3{5, 5, 5}));
}

TEST(VtkhdfMesh, RefusesTetrahedraThatChangeInTime) {
  const ScratchFolder folder;
  write_moving(folder / "m.vtkhdf", {0, 1});
  Hdf5Editor(folder / "m.vtkhdf")
      .dataset<std::int32_t>("VTKHDF/Connectivity", {16},
                             {0, 1, 2, 3, 1, 2, 3, 4,  //
                              0, 1, 2, 3, 1, 2, 4, 3})
      .dataset<std::int64_t>("VTKHDF/Steps/ConnectivityIdOffsets", {2}, {0, 8});

  const MeshReader reader(folder / "m.vtkhdf");

  EXPECT_NE(io_error([&] { reader.read_step(1); }).find("other cells"), std::string::npos);
}

/// One entry of NumberOfPoints per step with PartOffsets all zero, as some small writers do.
TEST(VtkhdfMesh, ReadsCountsRepeatedForEveryStep) {
  const ScratchFolder folder;
  write_mesh(folder / "m.vtkhdf", two_tets(), slides({1, 2}));
  Hdf5Editor(folder / "m.vtkhdf")
      .dataset<std::int64_t>("VTKHDF/NumberOfPoints", {2}, {5, 5})
      .dataset<std::int64_t>("VTKHDF/NumberOfCells", {2}, {2, 2})
      .dataset<std::int64_t>("VTKHDF/NumberOfConnectivityIds", {2}, {8, 8});

  const MeshReader reader(folder / "m.vtkhdf");

  EXPECT_EQ(reader.header().node_count, 5);
  EXPECT_EQ(reader.read_step(1)[0], (Point3{2, 0, 0}));
}

TEST(VtkhdfMesh, TakesDisplacementsThatAreNoNumberAtNodesOfNoCell) {
  const ScratchFolder folder;
  Mesh mesh = two_tets();
  mesh.rest_positions.push_back({9, 9, 9});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> rows(15, 1.0);
  rows.insert(rows.end(), 3, nan);
  write_mesh(folder / "m.vtkhdf", mesh);
  Hdf5Editor(folder / "m.vtkhdf").dataset("VTKHDF/PointData/displacement", {6, 3}, rows);

  const std::vector<Point3> moved = MeshReader(folder / "m.vtkhdf").read_step(0);
  EXPECT_EQ(moved[4], (Point3{2, 2, 2}));
  EXPECT_EQ(moved[5], (Point3{9, 9, 9}));
  rows[12] = nan;
  Hdf5Editor(folder / "m.vtkhdf").dataset("VTKHDF/PointData/displacement", {6, 3}, rows);
  EXPECT_NE(io_error([&] {
              MeshReader(folder / "m.vtkhdf").read_step(0);
            }).find("displacement: node 4 is not finite"),
            std::string::npos);
}

TEST(VtkhdfMesh, RefusesToWriteWhatCannotBeRead) {
  const ScratchFolder folder;
  Mesh outside = two_tets();
  outside.tets[1][2] = 5;
  auto bent = slides({1});
  bent[0][3][1] = std::numeric_limits<double>::infinity();

  EXPECT_THROW(write_mesh(folder / "m", outside), IoError);
  EXPECT_THROW(write_mesh(folder / "m", two_tets(), slides({1}), {0, 1}), IoError);
  EXPECT_THROW(write_mesh(folder / "m", two_tets(), {{{0, 0, 0}}}), IoError);
  EXPECT_THROW(write_mesh(folder / "m", two_tets(), bent), IoError);
  EXPECT_EQ(folder.entry_count(), 0);
}

TEST(VtkhdfMesh, KeepsTetrahedraAndHexahedraApart) {
  const ScratchFolder folder;
  Mesh mesh = two_tets();
  for (int n = 0; n < 8; ++n) {
    mesh.rest_positions.push_back({1.0 * (n == 1 || n == 2 || n == 5 || n == 6),
                                   1.0 * (n == 2 || n == 3 || n == 6 || n == 7), 1.0 * (n >= 4)});
  }
  const auto first = static_cast<std::int32_t>(two_tets().rest_positions.size());
  mesh.hexes = {
      {first, first + 1, first + 2, first + 3, first + 4, first + 5, first + 6, first + 7}};
  write_mesh(folder / "m.vtkhdf", mesh);

  const MeshReader reader(folder / "m.vtkhdf");

  EXPECT_EQ(reader.header().tet_count, 2);
  EXPECT_EQ(reader.header().hex_count, 1);
  EXPECT_EQ(reader.mesh().tets, mesh.tets);
  EXPECT_EQ(reader.mesh().hexes, mesh.hexes);
  EXPECT_EQ(reader.mesh().rest_positions, mesh.rest_positions);
}
}  // namespace
}  // namespace tetwarp::test
