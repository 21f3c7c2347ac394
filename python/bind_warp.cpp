/// @file bind_warp.cpp
/// The Warper.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <tetwarp/warp.hpp>
#include <utility>
#include <vector>

#include "host/base/report_fields.hpp"
#include "python/array_warper.hpp"
#include "python/arrays.hpp"
#include "python/bind.hpp"
#include "python/choices.hpp"
#include "python/curved_arrays.hpp"

namespace tetwarp::python {
namespace {
nb::dict dict_of(const Totals& totals) {
  nb::dict all;
  all["before"] = totals.before;
  all["after"] = totals.after;
  all["rounding"] = totals.rounding;
  all["clipping"] = totals.clipping;
  return all;
}

/// What a step did, and the members of the report that all steps share.
struct StepOf {
  StepReport step;
  Backend backend;
  std::string backend_reason, device;
  int threads;
  double position_quantum;
};

nb::dict dict_of(const StepOf& of) {
  nb::dict counts, timings, report;
  for (const auto& field : count_fields) counts[field.name] = of.step.counts.*field.member;
  for (const auto& field : timing_fields) timings[field.name] = of.step.timings.*field.member;
  report["backend"] = name_of(of.backend);
  report["backend_reason"] = of.backend_reason;
  report["device"] = of.device;
  report["threads"] = of.threads;
  report["position_quantum"] = of.position_quantum;
  report["step"] = of.step.step;
  report["counts"] = counts;
  report["timings"] = timings;
  report["totals"] = dict_of(of.step.totals);
  return report;
}

/// What all steps share, read after a step.
StepOf step_of(const ArrayWarper& warper, StepReport step) {
  const Report& whole = warper.shared();
  return {std::move(step), whole.backend, whole.backend_reason,
          whole.device,    whole.threads, whole.position_quantum};
}

StepOf run_step(ArrayWarper& warper,
                const AnyPoints& deformed,
                const std::vector<AnyOut>& volumes,
                const nb::dict& extras,
                std::uintptr_t stream,
                nb::object progress) {
  return step_of(warper, warper.step({deformed, volumes, extras, stream}, std::move(progress)));
}

void begin_warp_step(ArrayWarper& warper,
                     const AnyPoints& deformed,
                     const std::vector<AnyOut>& volumes,
                     const nb::dict& extras,
                     std::uintptr_t stream,
                     nb::object progress,
                     nb::object given) {
  warper.begin_step({deformed, volumes, extras, stream}, std::move(given), std::move(progress));
}

std::pair<nb::object, StepOf> finish_warp_step(ArrayWarper& warper) {
  auto [given, step] = warper.finish_step();
  return {std::move(given), step_of(warper, std::move(step))};
}

void make_array_warper(ArrayWarper* self,
                       std::vector<AnySamples> sources,
                       const Grid& grid,
                       const InPoints& points,
                       const InTets& tets,
                       const InHexes& hexes,
                       const InMidNodes& mids,
                       const std::string& interpolator,
                       const std::string& label_rule,
                       const std::array<double, 2>& label_gaussian,
                       const std::string& overshoot,
                       bool antialias,
                       const std::string& intensity,
                       const std::vector<std::string>& quantities,
                       const std::string& outside,
                       double falloff,
                       double default_value,
                       std::optional<Grid> output_grid,
                       const std::string& backend,
                       int device,
                       int threads) {
  WarpOptions options{.filter = choice<Filter>("interpolator", interpolator),
                      .label_rule = choice<LabelRule>("label_rule", label_rule),
                      .label_gaussian = {label_gaussian[0], label_gaussian[1]},
                      .overshoot = choice<Overshoot>("overshoot", overshoot),
                      .antialias = antialias,
                      .intensity = choice<Intensity>("intensity", intensity),
                      .outside = choice<Outside>("outside", outside),
                      .falloff = falloff,
                      .background = default_value,
                      .output_grid = output_grid,
                      .backend = choice<Backend>("backend", backend),
                      .device = device,
                      .threads = threads};
  for (const std::string& word : quantities) {
    options.quantities.push_back(choice<Quantity>("quantity", word));
  }
  new (self)
      ArrayWarper(std::move(sources), grid, curved_mesh_of(points, tets, hexes, mids), options);
}
}  // namespace

void bind_warp(nb::module_& module) {
  nb::class_<StepOf>(module, "StepReport").def("dict", [](const StepOf& self) {
    return dict_of(self);
  });
  nb::class_<ArrayWarper>(module, "Warper")
      .def("__init__", &make_array_warper, nb::arg("sources"), nb::arg("grid"), nb::arg("points"),
           nb::arg("tets"), nb::arg("hexes"), nb::arg("mids"), nb::kw_only(),
           nb::arg("interpolator"), nb::arg("label_rule"), nb::arg("label_gaussian"),
           nb::arg("overshoot"), nb::arg("antialias"), nb::arg("intensity"), nb::arg("quantities"),
           nb::arg("outside"), nb::arg("falloff"), nb::arg("default_value"),
           nb::arg("output_grid").none(), nb::arg("backend"), nb::arg("device"), nb::arg("threads"))
      .def("report", &ArrayWarper::report)
      .def("step", &run_step, nb::arg("deformed"), nb::arg("volumes"), nb::arg("extras"),
           nb::arg("stream"), nb::arg("progress").none())
      .def("begin_step", &begin_warp_step, nb::arg("deformed"), nb::arg("volumes"),
           nb::arg("extras"), nb::arg("stream"), nb::arg("progress").none(), nb::arg("given"))
      .def("finish_step", &finish_warp_step)
      .def_prop_ro("steps_in_flight", &ArrayWarper::steps_in_flight);
}

}  // namespace tetwarp::python
