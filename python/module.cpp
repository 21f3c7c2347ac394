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
  if (PyInterpreterState_GetID(PyInterpreterState_Get()) != 0) {
    throw nb::import_error(
        "tetwarp: sub-interpreters are not supported; import it in the main interpreter or in "
        "another process");
  }
  module.doc() = "The library behind the package tetwarp.";
  module.attr("version") = TETWARP_VERSION;
  const nb::exception<CudaError> cuda_error(module, "CudaError", PyExc_RuntimeError);
  const nb::exception<IoError> io_error(module, "IoError", PyExc_OSError);
  const nb::exception<Cancelled> cancelled(module, "Cancelled", PyExc_RuntimeError);
  module.def("available_backends", &backends, nb::arg("device") = 0,
             "A dict per back end: backend, usable, device, and why it is not usable.");
  python::bind_volume(module);
  python::bind_mesh(module);
  python::bind_warp(module);
  python::bind_operator(module);
  python::bind_files(module);
  python::bind_certify(module);
  python::bind_contact(module);
  python::bind_tracker(module);
  python::bind_simulate(module);
}
