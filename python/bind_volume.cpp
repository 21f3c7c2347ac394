/// @file bind_volume.cpp
/// Grids and phantoms.
#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>

#include <array>
#include <cstdint>
#include <stdexcept>
#include <tetwarp/make.hpp>

#include "python/arrays.hpp"
#include "python/bind.hpp"

namespace tetwarp::python {
namespace {
Volume phantom(const std::string& kind,
               const std::array<std::int64_t, 3>& dims,
               const Point3& spacing) {
  if (kind == "torso") return make_phantom(dims);
  if (kind == "orange") return make_orange_phantom(dims, spacing);
  if (kind == "fish") return make_fish_phantom(dims, spacing);
  throw std::invalid_argument("kind: '" + kind + "' is not one of torso, orange, fish");
}
}  // namespace

void bind_volume(nb::module_& module) {
  nb::class_<Grid>(module, "Grid")
      .def(
          "__init__",
          [](Grid* self, const std::array<std::int64_t, 3>& dims, const Point3& origin,
             const Point3& spacing, const std::array<double, 9>& direction) {
            const Grid grid{dims, origin, spacing, direction};
            check_grid(grid, "grid");
            new (self) Grid(grid);
          },
          nb::arg("dims"), nb::arg("origin"), nb::arg("spacing"), nb::arg("direction"))
      .def_ro("dims", &Grid::dims)
      .def_ro("origin", &Grid::origin)
      .def_ro("spacing", &Grid::spacing)
      .def_ro("direction", &Grid::direction);
  module.def(
      "phantom",
      [](const std::string& kind, const std::array<std::int64_t, 3>& dims, const Point3& spacing) {
        Volume volume = phantom(kind, dims, spacing);
        const Grid grid = volume.grid;
        return nb::make_tuple(array_of(std::move(volume)), grid);
      },
      nb::arg("kind"), nb::arg("dims"), nb::arg("spacing"));
}

}  // namespace tetwarp::python
