/// @file arrays.hpp
/// Arrays of Python as the library's views, and the library's vectors as arrays. Neither copies
/// samples; meshes are copied, because a Mesh owns its memory.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <tetwarp/mesh.hpp>
#include <tetwarp/volume.hpp>
#include <utility>
#include <vector>

namespace tetwarp::python {

namespace nb = nanobind;

/// Arrays in C order in host memory; the package has checked type and shape and says what is wrong.
template <class T, class... Shape>
using In = nb::ndarray<const T, nb::c_contig, nb::device::cpu, Shape...>;
using InPoints = In<double, nb::shape<-1, 3>>;
using InTets = In<std::int32_t, nb::shape<-1, 4>>;
using InTriangles = In<std::int32_t, nb::shape<-1, 3>>;
using InHexes = In<std::int32_t, nb::shape<-1, 8>>;
using InSamples = nb::ndarray<nb::ro, nb::c_contig, nb::device::cpu>;  ///< of any pixel type
/// The same in host memory or that of a CUDA device.
using AnySamples = nb::ndarray<nb::ro, nb::c_contig>;
using AnyOut = nb::ndarray<nb::c_contig>;  ///< writable
using AnyPoints = nb::ndarray<const double, nb::c_contig, nb::shape<-1, 3>>;
using NumpyArray = nb::ndarray<nb::numpy>;

/// @throws std::invalid_argument  the type is not a pixel type
PixelType pixel_type_of(const nb::dlpack::dtype& type);
nb::dlpack::dtype dtype_of(PixelType type);

/// Memory::device for that of a CUDA device, also for that which a device shares with the host.
template <class Array>
Memory memory_of(const Array& array) {
  const int kind = array.device_type();
  return kind == nb::device::cuda::value || kind == nb::device::cuda_managed::value ? Memory::device
                                                                                    : Memory::host;
}

/// Samples of shape [k][j][i] or [k][j][i][component], as a view that does not own them.
/// @throws std::invalid_argument  the shape is not that of the grid, or the type no pixel type
VolumeView view_of(const AnySamples& samples, const Grid& grid);
/// The same as a Volume, which copies them.
Volume volume_of(const InSamples& samples, const Grid& grid, const std::string& name);
/// The samples of a volume as an array of shape [k][j][i] or, with several components,
/// [k][j][i][component], which owns their memory.
NumpyArray array_of(Volume&& volume);

Mesh mesh_of(const InPoints& points, const InTets& tets, const InHexes& hexes);
std::vector<Point3> points_of(const InPoints& points);
std::vector<std::array<std::int32_t, 4>> tets_of(const InTets& tets);
std::vector<std::array<std::int32_t, 3>> triangles_of(const InTriangles& triangles);

/// A vector as an array that owns it. @param Number  of the elements, which are numbers or
/// std::array of numbers
template <class Number, class Element>
NumpyArray array_of(std::vector<Element> values, std::initializer_list<std::size_t> shape) {
  auto* const kept = new std::vector<Element>(std::move(values));
  const nb::capsule owner(
      kept, [](void* pointer) noexcept { delete static_cast<std::vector<Element>*>(pointer); });
  return NumpyArray(kept->data(), shape.size(), shape.begin(), owner, nullptr, nb::dtype<Number>());
}

template <class Number>
NumpyArray array_of(std::vector<Number> values) {
  const std::size_t size = values.size();
  return array_of<Number>(std::move(values), {size});
}

/// Rows of a fixed number of columns.
template <class Number, std::size_t columns>
NumpyArray array_of(std::vector<std::array<Number, columns>> values) {
  const std::size_t size = values.size();
  return array_of<Number>(std::move(values), {size, columns});
}

/// A copy of an array as a vector.
template <class T, class... Shape>
std::vector<T> vector_of(const In<T, Shape...>& values) {
  return values.size() == 0 ? std::vector<T>()
                            : std::vector<T>(values.data(), values.data() + values.size());
}

}  // namespace tetwarp::python
