/// @file bind_volume.cpp
/// Grids and phantoms.
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>

#include <array>
#include <cstdint>
#include <stdexcept>
#include <tetwarp/make.hpp>
#include <vector>

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

using WritableArray = nb::ndarray<nb::device::cpu>;

NumpyArray writable_array(const WritableArray& array) {
  std::vector<std::size_t> shape;
  std::vector<std::int64_t> strides;
  for (std::size_t axis = 0; axis < array.ndim(); ++axis) {
    shape.push_back(array.shape(axis));
    strides.push_back(array.stride(axis));
  }
  const nb::capsule owner(new WritableArray(array), [](void* pointer) noexcept {
    delete static_cast<WritableArray*>(pointer);
  });
  return NumpyArray(array.data(), shape.size(), shape.data(), owner, strides.data(), array.dtype());
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
  module.def("writable_array", &writable_array, nb::arg("array"),
             "An array of any library in host memory as one of NumPy, by DLPack.");
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
