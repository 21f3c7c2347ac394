/// @file bind.hpp
/// The parts of the module.
#pragma once
#include <nanobind/nanobind.h>

namespace tetwarp::python {

void bind_certify(nanobind::module_& module);
void bind_compose(nanobind::module_& module);
void bind_contact(nanobind::module_& module);
void bind_files(nanobind::module_& module);
void bind_mesh(nanobind::module_& module);
void bind_operator(nanobind::module_& module);
void bind_resample(nanobind::module_& module);
void bind_simulate(nanobind::module_& module);
void bind_tracker(nanobind::module_& module);
void bind_volume(nanobind::module_& module);
void bind_warp(nanobind::module_& module);

}  // namespace tetwarp::python
