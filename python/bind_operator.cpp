/// @file bind_operator.cpp
/// The warp as a linear operator.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <optional>
#include <span>
#include <string>
#include <tetwarp/warp_operator.hpp>

#include "python/arrays.hpp"
#include "python/bind.hpp"
#include "python/choices.hpp"
#include "python/interpreter_lock.hpp"

namespace tetwarp::python {
namespace {
using InNumbers = In<double>;
using OutNumbers = nb::ndarray<double, nb::c_contig, nb::device::cpu>;

std::span<const double> span_of(const InNumbers& array) {
  return {array.data(), array.size()};
}

void make_operator(WarpOperator* self,
                   const Grid& source,
                   const InPoints& points,
                   const InTets& tets,
                   const InHexes& hexes,
                   const InPoints& deformed,
                   const std::string& interpolator,
                   const std::string& intensity,
                   const std::string& outside,
                   std::optional<Grid> output_grid,
                   const In<std::uint8_t>& mask,
                   int threads) {
  const WarpOperatorOptions options{.filter = choice<Filter>("interpolator", interpolator),
                                    .intensity = choice<Intensity>("intensity", intensity),
                                    .outside = choice<Outside>("outside", outside),
                                    .output_grid = output_grid,
                                    .mask = vector_of(mask),
                                    .threads = threads};
  const Mesh mesh = mesh_of(points, tets, hexes);
  const std::vector<Point3> nodes = points_of(deformed);
  const LockReleased release;
  new (self) WarpOperator(source, mesh, nodes, options);
}

void apply_forward(const WarpOperator& self, const InNumbers& x, const OutNumbers& y) {
  const std::span<double> out(y.data(), y.size());
  const LockReleased release;
  self.forward(span_of(x), out);
}

void apply_adjoint(const WarpOperator& self, const InNumbers& y, const OutNumbers& x) {
  const std::span<double> out(x.data(), x.size());
  const LockReleased release;
  self.adjoint(span_of(y), out);
}

NumpyArray gradient_of(const WarpOperator& self, const InNumbers& x, const InNumbers& y) {
  std::vector<Point3> gradient;
  {
    const LockReleased release;
    gradient = self.node_gradient(span_of(x), span_of(y));
  }
  return array_of<double>(std::move(gradient));
}
}  // namespace

void bind_operator(nb::module_& module) {
  nb::class_<WarpOperator>(module, "WarpOperator")
      .def("__init__", &make_operator, nb::arg("source"), nb::arg("points"), nb::arg("tets"),
           nb::arg("hexes"), nb::arg("deformed"), nb::kw_only(), nb::arg("interpolator"),
           nb::arg("intensity"), nb::arg("outside"), nb::arg("output_grid").none(), nb::arg("mask"),
           nb::arg("threads"))
      .def("support",
           [](const WarpOperator& self) { return array_of<std::uint8_t>(self.support()); })
      .def("forward", &apply_forward, nb::arg("x"), nb::arg("y"))
      .def("adjoint", &apply_adjoint, nb::arg("y"), nb::arg("x"))
      .def("node_gradient", &gradient_of, nb::arg("x"), nb::arg("y"));
}

}  // namespace tetwarp::python
