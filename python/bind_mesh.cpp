/// @file bind_mesh.cpp
/// Lattices, surfaces, procedural deformations, owners of points.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <tetwarp/make.hpp>
#include <tetwarp/map_points.hpp>
#include <tetwarp/surface.hpp>
#include <utility>
#include <vector>

#include "host/base/repeated_cells.hpp"
#include "python/arrays.hpp"
#include "python/bind.hpp"
#include "python/choices.hpp"
#include "python/curved_arrays.hpp"
#include "python/interpreter_lock.hpp"

namespace tetwarp::python {
namespace {
nb::tuple lattice_mesh(const InSamples& samples,
                       const Grid& grid,
                       int cells,
                       std::optional<double> threshold,
                       bool hexahedra) {
  Mesh mesh;
  {
    const LockReleased release;
    mesh = make_lattice_mesh(volume_of(samples, grid, "volume"), {cells, threshold, hexahedra});
  }
  nb::object cells_array = hexahedra ? nb::cast(array_of(std::move(mesh.hexes)))
                                     : nb::cast(array_of(std::move(mesh.tets)));
  return nb::make_tuple(array_of(std::move(mesh.rest_positions)), cells_array);
}

NumpyArray deform(const InPoints& points,
                  const InTets& tets,
                  const InHexes& hexes,
                  const std::string& kind,
                  double amount,
                  int axis,
                  std::uint64_t seed,
                  const Point3& offset,
                  double time) {
  const Mesh mesh = mesh_of(points, tets, hexes);
  const DeformOptions options{.kind = choice<Deformation>("kind", kind),
                              .amount = amount,
                              .axis = axis,
                              .seed = seed,
                              .offset = offset};
  return array_of(deform_positions(mesh, options, time));
}

/// Per cell 1 where no cell before it is the same, as files are read.
NumpyArray are_first(const std::vector<std::size_t>& firsts) {
  std::vector<std::uint8_t> flags;
  for (std::size_t c = 0; c < firsts.size(); ++c) flags.push_back(firsts[c] == c);
  return array_of(std::move(flags));
}

nb::tuple surface_arrays(Surface surface) {
  return nb::make_tuple(array_of(std::move(surface.points)),
                        array_of(std::move(surface.triangles)));
}
}  // namespace

void bind_mesh(nb::module_& module) {
  module.def("lattice_mesh", &lattice_mesh, nb::arg("samples"), nb::arg("grid"), nb::arg("cells"),
             nb::arg("threshold").none(), nb::arg("hexahedra"));
  module.def("deform", &deform, nb::arg("points"), nb::arg("tets"), nb::arg("hexes"),
             nb::arg("kind"), nb::arg("amount"), nb::arg("axis"), nb::arg("seed"),
             nb::arg("offset"), nb::arg("time"));
  module.def(
      "boundary_surface",
      [](const InPoints& points, const InTets& tets, const InHexes& hexes) {
        return surface_arrays(boundary_surface(mesh_of(points, tets, hexes)));
      },
      nb::arg("points"), nb::arg("tets"), nb::arg("hexes"));
  module.def(
      "first_triangles",
      [](const InPoints& points, const InTriangles& triangles) {
        return are_first(
            first_copies(points_of(points), triangles_of(triangles), SameCells::turned_places));
      },
      nb::arg("points"), nb::arg("triangles"));
  module.def(
      "first_cells",
      [](const InPoints& points, const InTets& tets, const InHexes& hexes, const InMidNodes& mids) {
        const CurvedMesh mesh = curved_mesh_of(points, tets, hexes, mids);
        const std::vector<Point3>& nodes = mesh.mesh.rest_positions;
        return nb::make_tuple(are_first(first_tet_copies(nodes, mesh.mesh.tets, mesh.mid_nodes)),
                              are_first(first_copies(nodes, mesh.mesh.hexes, SameCells::places)));
      },
      nb::arg("points"), nb::arg("tets"), nb::arg("hexes"), nb::arg("mids"));
  module.def(
      "isosurface",
      [](const InSamples& samples, const Grid& grid, double value,
         std::optional<std::int64_t> triangles) {
        Surface surface;
        {
          const LockReleased release;
          surface = make_isosurface(volume_of(samples, grid, "volume"), value, triangles);
        }
        return surface_arrays(std::move(surface));
      },
      nb::arg("samples"), nb::arg("grid"), nb::arg("value"), nb::arg("triangles").none());
  module.def(
      "map_points",
      [](const InPoints& points, const std::optional<Grid>& grid, const InPoints& rest,
         const InTets& tets, const InHexes& hexes, const InMidNodes& mids, const InPoints& deformed,
         bool inverse) {
        MappedPoints mapped;
        {
          const LockReleased release;
          mapped = map_points(curved_mesh_of(rest, tets, hexes, mids), points_of(deformed),
                              points_of(points), {.inverse = inverse, .grid = grid});
        }
        return nb::make_tuple(array_of(std::move(mapped.points)),
                              array_of(std::move(mapped.owners)), mapped.straightened);
      },
      nb::arg("points"), nb::arg("grid").none(), nb::arg("rest"), nb::arg("tets"), nb::arg("hexes"),
      nb::arg("mids"), nb::arg("deformed"), nb::arg("inverse"));
  module.def(
      "split_ten_nodes",
      [](const InTets& tets, const InMidNodes& mids) {
        const CurvedMesh mesh{{{}, tets_of(tets), {}}, mid_nodes_of(mids)};
        return array_of(split_curved(mesh).tets);
      },
      nb::arg("tets"), nb::arg("mids"));
}

}  // namespace tetwarp::python
