/// @file arrays.cpp
/// Pixel types, volumes and meshes.
#include "python/arrays.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>

namespace tetwarp::python {
namespace {
/// Rows of numbers as elements of fixed size.
template <class Element, class Array>
std::vector<Element> rows_of(const Array& rows) {
  std::vector<Element> elements(rows.shape(0));
  if (!elements.empty()) std::memcpy(elements.data(), rows.data(), rows.nbytes());
  return elements;
}
}  // namespace

PixelType pixel_type_of(const nb::dlpack::dtype& type) {
  for (int number = 0; number <= static_cast<int>(PixelType::float64); ++number) {
    const auto pixel = static_cast<PixelType>(number);
    if (dtype_of(pixel) == type) return pixel;
  }
  throw std::invalid_argument("expected samples of 8- to 64-bit integers, float32 or float64");
}

nb::dlpack::dtype dtype_of(PixelType type) {
  switch (type) {
    case PixelType::uint8:
      return nb::dtype<std::uint8_t>();
    case PixelType::int8:
      return nb::dtype<std::int8_t>();
    case PixelType::uint16:
      return nb::dtype<std::uint16_t>();
    case PixelType::int16:
      return nb::dtype<std::int16_t>();
    case PixelType::uint32:
      return nb::dtype<std::uint32_t>();
    case PixelType::int32:
      return nb::dtype<std::int32_t>();
    case PixelType::uint64:
      return nb::dtype<std::uint64_t>();
    case PixelType::int64:
      return nb::dtype<std::int64_t>();
    case PixelType::float32:
      return nb::dtype<float>();
    case PixelType::float64:
      break;
  }
  return nb::dtype<double>();
}

VolumeView view_of(const AnySamples& samples, const Grid& grid) {
  bool fits = samples.ndim() == 3 || samples.ndim() == 4;
  for (std::size_t axis = 0; fits && axis < 3; ++axis) {
    fits = static_cast<std::int64_t>(samples.shape(axis)) == grid.dims[2 - axis];
  }
  if (!fits) throw std::invalid_argument("samples: expected the shape of the grid, z y x");
  const int components = samples.ndim() == 4 ? static_cast<int>(samples.shape(3)) : 1;
  return {grid, pixel_type_of(samples.dtype()), components, samples.data(), memory_of(samples)};
}

Volume volume_of(const InSamples& samples, const Grid& grid, const std::string& name) {
  const VolumeView view = view_of(AnySamples(samples), grid);
  Volume volume = make_volume(grid, view.type, view.components, name);
  std::memcpy(volume.data.data(), samples.data(), volume.data.size());
  return volume;
}

NumpyArray array_of(Volume&& volume) {
  auto* const kept = new Volume(std::move(volume));
  const nb::capsule owner(kept,
                          [](void* pointer) noexcept { delete static_cast<Volume*>(pointer); });
  const auto size = [&](std::size_t axis) {
    return static_cast<std::size_t>(kept->grid.dims[axis]);
  };
  const std::array<std::size_t, 4> shape{size(2), size(1), size(0),
                                         static_cast<std::size_t>(kept->components)};
  const std::size_t axes = kept->components == 1 ? 3 : 4;
  return NumpyArray(kept->data.data(), axes, shape.data(), owner, nullptr, dtype_of(kept->type));
}

Mesh mesh_of(const InPoints& points, const InTets& tets, const InHexes& hexes) {
  return {points_of(points), tets_of(tets), rows_of<std::array<std::int32_t, 8>>(hexes)};
}

std::vector<Point3> points_of(const InPoints& points) {
  return rows_of<Point3>(points);
}

std::vector<std::array<std::int32_t, 4>> tets_of(const InTets& tets) {
  return rows_of<std::array<std::int32_t, 4>>(tets);
}

std::vector<std::array<std::int32_t, 3>> triangles_of(const InTriangles& triangles) {
  return rows_of<std::array<std::int32_t, 3>>(triangles);
}

}  // namespace tetwarp::python
