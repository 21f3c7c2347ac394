/// @file test_repeated_cells.cpp
/// Cells that are there twice, and cells that only share nodes.
#include "host/base/repeated_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <tetwarp/surface.hpp>
#include <utility>

#include "tests/support/torn_mesh.hpp"

namespace tetwarp::test {
namespace {
using Firsts = std::vector<std::size_t>;

const Surface cube{
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}},
    {{0, 2, 1},
     {0, 3, 2},
     {4, 5, 6},
     {4, 6, 7},
     {0, 1, 5},
     {0, 5, 4},
     {1, 2, 6},
     {1, 6, 5},
     {2, 3, 7},
     {2, 7, 6},
     {3, 0, 4},
     {3, 4, 7}}};

TEST(RepeatedCells, OfTenNodesAreTheSameWhereTheirEdgesAreBentAlike) {
  const std::vector<Point3> points = {{0, 0, 0},    {2, 0, 0}, {0, 2, 0}, {0, 0, 2},
                                      {1, 0, 0.25}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1},
                                      {1, 0, 1},    {0, 1, 1}, {1, 0, 0}};
  const std::vector<std::array<std::int32_t, 4>> tets = {
      {0, 1, 2, 3}, {1, 0, 3, 2}, {0, 1, 2, 3}, {0, 1, 2, 3}, {3, 2, 1, 0}};
  const std::vector<MidNodes> mid_nodes = {{4, 5, 6, 7, 8, 9},
                                           {4, 7, 8, 5, 6, 9},   // the first, from another corner
                                           {10, 5, 6, 7, 8, 9},  // another bend
                                           no_mid_nodes,
                                           {9, 5, 8, 7, 6, 4}};

  EXPECT_EQ(first_tet_copies(points, tets, mid_nodes), (Firsts{0, 0, 2, 3, 0}));
  EXPECT_EQ(first_tet_copies(points, tets, {}), (Firsts{0, 0, 0, 0, 0}));
}

/// Copies of some tetrahedra, with corners in another order and with nodes of their own or not.
TEST(RepeatedCells, AreFoundAmongTetrahedraWhateverTheirNodesAndOrder) {
  const Mesh whole = make_lattice_mesh(cube, 3);
  for (const std::uint32_t seed : {1, 2, 3}) {
    Mesh mesh = torn(whole, seed);
    Firsts expected(mesh.tets.size());
    for (std::size_t t = 0; t < expected.size(); ++t) expected[t] = t;
    EXPECT_EQ(first_copies(mesh.rest_positions, mesh.tets, SameCells::places), expected);
    std::mt19937 random(seed);
    for (std::size_t n = 0; n < 40; ++n) {
      const std::size_t of = random() % mesh.tets.size();
      auto tet = mesh.tets[of];
      std::shuffle(tet.begin(), tet.end(), random);
      for (std::int32_t& node : tet) {
        if (seed % 2 == 0) continue;
        mesh.rest_positions.push_back(mesh.rest_positions[static_cast<std::size_t>(node)]);
        node = static_cast<std::int32_t>(mesh.rest_positions.size() - 1);
      }
      mesh.tets.push_back(tet);
      expected.push_back(expected[of]);
    }

    const Firsts firsts = first_copies(mesh.rest_positions, mesh.tets, SameCells::places);

    EXPECT_EQ(firsts, expected);
    EXPECT_EQ(copy_count(firsts), 40u);
    keep_firsts(firsts, mesh.tets);
    EXPECT_EQ(mesh.tets, torn(whole, seed).tets);
  }
}

TEST(RepeatedCells, BackToBackTrianglesAreTwoFacesButOneCloth) {
  const std::vector<Point3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                                   {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<std::array<std::int32_t, 3>> triangles{
      {0, 1, 2}, {0, 2, 1}, {1, 2, 0}, {3, 4, 5}, {3, 5, 4}};

  EXPECT_EQ(first_copies(points, triangles, SameCells::turned_places), (Firsts{0, 1, 0, 0, 1}));
  EXPECT_EQ(first_copies(points, triangles, SameCells::nodes), (Firsts{0, 0, 0, 3, 3}));
}

/// Cells without extent at one place are not the same for that.
TEST(RepeatedCells, CollapsedCellsAreToldByTheirNodes) {
  const std::vector<Point3> points(8, Point3{0, -0.0, 0});
  const std::vector<std::array<std::int32_t, 4>> tets{{0, 1, 2, 3}, {4, 5, 6, 7}, {3, 2, 1, 0}};

  EXPECT_EQ(first_copies(points, tets, SameCells::places), (Firsts{0, 1, 0}));
}

}  // namespace
}  // namespace tetwarp::test
