/// @file bind_resample.cpp
/// Volumes resampled by affine transforms and displacement fields.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <tetwarp/resample.hpp>
#include <utility>
#include <vector>

#include "python/arrays.hpp"
#include "python/bind.hpp"
#include "python/choices.hpp"
#include "python/interruption.hpp"
#include "python/overlap.hpp"

namespace tetwarp::python {
namespace {
/// An array of shape (4, 4), or a pair of a grid and displacements (z, y, x, 3).
SingleTransform link_of(const nb::handle& given) {
  if (nb::isinstance<nb::tuple>(given)) {
    const auto [grid, values] = nb::cast<std::pair<Grid, In<float>>>(given);
    return DisplacementField{grid, vector_of(values)};
  }
  const auto matrix = nb::cast<In<double, nb::shape<4, 4>>>(given);
  AffineTransform affine;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      affine.matrix[3 * row + column] = matrix(row, column);
    }
    affine.offset[row] = matrix(row, 3);
  }
  return affine;
}

void resample_arrays(const std::vector<AnySamples>& sources,
                     const Grid& grid,
                     const nb::list& links,
                     const std::vector<AnyOut>& outputs,
                     const nb::dict& options,
                     std::optional<Grid> output_grid,
                     nb::object progress) {
  check_outputs(outputs, sources);
  std::vector<VolumeView> views;
  for (const AnySamples& source : sources) views.push_back(view_of(source, grid));
  std::vector<void*> samples;
  for (const AnyOut& output : outputs) samples.push_back(output.data());
  TransformChain chain;
  for (const nb::handle& link : links) chain.links.push_back(link_of(link));
  const Transform transform = std::move(chain);  // displacements are not copied
  const auto word = [&](const char* name) { return nb::cast<std::string>(options[name]); };
  const auto gaussian = nb::cast<std::array<double, 2>>(options["label_gaussian"]);
  const ResampleOptions chosen{.filter = choice<Filter>("interpolator", word("interpolator")),
                               .label_rule = choice<LabelRule>("label_rule", word("label_rule")),
                               .label_gaussian = {gaussian[0], gaussian[1]},
                               .overshoot = choice<Overshoot>("overshoot", word("overshoot")),
                               .background = nb::cast<double>(options["default_value"]),
                               .only_in_field = nb::cast<bool>(options["only_in_field"]),
                               .output_grid = output_grid,
                               .threads = nb::cast<int>(options["threads"])};
  Interruption interruption(std::move(progress));
  interruption.run([&] {
    resample(views, transform, chosen, samples,
             [&](double fraction) { return interruption.go_on(fraction); });
  });
}
}  // namespace

void bind_resample(nb::module_& module) {
  module.def("resample", &resample_arrays, nb::arg("sources"), nb::arg("grid"), nb::arg("links"),
             nb::arg("outputs"), nb::arg("options"), nb::arg("output_grid").none(),
             nb::arg("progress").none());
}

}  // namespace tetwarp::python
