/// @file bind_compose.cpp
/// Transforms joined to one field, and inverses.
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <cstddef>
#include <utility>
#include <vector>

#include "host/warp/compose/compose.hpp"
#include "host/warp/compose/mesh_inverse.hpp"
#include "python/arrays.hpp"
#include "python/bind.hpp"
#include "python/curved_arrays.hpp"
#include "python/interruption.hpp"
#include "python/transforms.hpp"

namespace tetwarp::python {
namespace {
/// @param given  as transform_of(); or nodes at rest, tetrahedra, hexahedra, nodes on edges and
///               deformed nodes
ComposeLink compose_link(const nb::handle& given, bool is_inverse) {
  constexpr std::size_t mesh_parts = 5;
  if (nb::len(given) != mesh_parts) return {transform_of<Transform>(given), is_inverse};
  return {MovedMesh{curved_mesh_of(nb::cast<InPoints>(given[0]), nb::cast<InTets>(given[1]),
                                   nb::cast<InHexes>(given[2]), nb::cast<InMidNodes>(given[3])),
                    points_of(nb::cast<InPoints>(given[4]))},
          is_inverse};
}

/// @param given  pairs of a transform and whether its inverse is meant
nb::tuple compose_arrays(const std::vector<std::pair<nb::object, bool>>& given,
                         const Grid& grid,
                         int threads,
                         nb::object progress) {
  std::vector<ComposeLink> links;
  for (const auto& [transform, is_inverse] : given) {
    links.push_back(compose_link(transform, is_inverse));
  }
  std::vector<const ComposeLink*> pointers;
  for (const ComposeLink& link : links) pointers.push_back(&link);
  Interruption interruption(std::move(progress));
  ComposedField result = interruption.run([&] {
    return compose(pointers, grid, threads,
                   [&](double fraction) { return interruption.go_on(fraction); });
  });
  const ComposeNotes& notes = result.notes;
  return nb::make_tuple(array_of(std::move(result.field)), array_of(std::move(result.reached)),
                        notes.outside, notes.straightened, notes.not_inverted,
                        notes.largest_residual);
}

nb::dict mesh_inverse(const InPoints& rest,
                      const InTets& tets,
                      const InHexes& hexes,
                      const InMidNodes& mids,
                      const InPoints& deformed) {
  InverseCheck check;
  {
    const LockReleased release;
    check = check_inverse(curved_mesh_of(rest, tets, hexes, mids), points_of(deformed));
  }
  nb::dict all;
  all["inverted"] = check.inverted;
  all["points"] = check.points;
  all["straightened"] = check.straightened;
  all["folded"] = check.folded;
  all["beside"] = check.beside;
  all["beside_error"] = check.beside_error;
  all["largest_error"] = check.largest_error;
  return all;
}

NumpyArray inverse_matrix(const InMatrix& matrix) {
  const AffineTransform inverse = inverse_of(affine_of(matrix));
  std::vector<double> rows;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      rows.push_back(inverse.matrix[3 * row + column]);
    }
    rows.push_back(inverse.offset[row]);
  }
  rows.insert(rows.end(), {0, 0, 0, 1});
  return array_of<double>(std::move(rows), {4, 4});
}
}  // namespace

void bind_compose(nb::module_& module) {
  module.def("compose", &compose_arrays, nb::arg("links"), nb::arg("grid"), nb::arg("threads"),
             nb::arg("progress").none());
  module.def("check_inverse", &mesh_inverse, nb::arg("rest"), nb::arg("tets"), nb::arg("hexes"),
             nb::arg("mids"), nb::arg("deformed"));
  module.def("inverse_matrix", &inverse_matrix, nb::arg("matrix"));
}

}  // namespace tetwarp::python
