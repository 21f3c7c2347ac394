/// @file module.cpp
/// The module tetwarp._core: what the package tetwarp calls. Arguments are checked and named by the
/// package.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <string>
#include <tetwarp/backend.hpp>
#include <tetwarp/error.hpp>
#include <tetwarp/version.hpp>

#include "python/bind.hpp"

namespace nb = nanobind;

namespace {
nb::list backends(int device) {
  nb::list all;
  for (const tetwarp::BackendStatus& status : tetwarp::available_backends(device)) {
    nb::dict entry;
    entry["backend"] = tetwarp::name_of(status.backend);
    entry["usable"] = status.usable;
    entry["device"] = status.device;
    entry["reason"] = status.reason;
    all.append(entry);
  }
  return all;
}
}  // namespace

NB_MODULE(_core, module) {
  using namespace tetwarp;
  module.doc() = "The library behind the package tetwarp.";
  module.attr("version") = TETWARP_VERSION;
  nb::exception<CudaError>(module, "CudaError", PyExc_RuntimeError);
  nb::exception<IoError>(module, "IoError", PyExc_OSError);
  nb::exception<Cancelled>(module, "Cancelled", PyExc_RuntimeError);
  module.def("available_backends", &backends, nb::arg("device") = 0,
             "A dict per back end: backend, usable, device, and why it is not usable.");
  python::bind_volume(module);
  python::bind_mesh(module);
  python::bind_warp(module);
  python::bind_files(module);
  python::bind_contact(module);
  python::bind_simulate(module);
}
