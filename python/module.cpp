/// @file module.cpp
/// The module tetwarp._core: what the package tetwarp calls. Arguments are checked and named by the
/// package.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <cstddef>
#include <exception>
#include <string>
#include <string_view>
#include <tetwarp/backend.hpp>
#include <tetwarp/error.hpp>
#include <tetwarp/missing_library.hpp>
#include <tetwarp/version.hpp>
#include <utility>

#include "python/bind.hpp"
#include "python/text.hpp"

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

/// A remedy that names options of the command, in words of the package.
std::string in_words_of_python(std::string text) {
  constexpr std::pair<std::string_view, std::string_view> words[] = {
      {"--axes lps", "axes=\"lps\""},
      {"--rest-step", "rest_step"},
      {"--series UID", "read_dicom(series=)"},
      {" (without --temporal, by --source-step)", ""}};
  for (const auto& [option, argument] : words) {
    const std::size_t place = text.find(option);
    if (place != std::string::npos) text.replace(place, option.size(), argument);
  }
  return text;
}

/// Raises an error about a file, whose text may hold bytes of the file.
void raise_io_error(const std::exception_ptr& pointer, void* module) {
  const nb::handle core(static_cast<PyObject*>(module));
  try {
    std::rethrow_exception(pointer);
  } catch (const tetwarp::MissingLibrary& error) {
    const nb::object instance = core.attr("MissingLibrary")(tetwarp::python::text_of(error.what()));
    instance.attr("library") = error.library();
    PyErr_SetObject(instance.type().ptr(), instance.ptr());
  } catch (const tetwarp::IoError& error) {
    const nb::object instance =
        core.attr("IoError")(tetwarp::python::text_of(in_words_of_python(error.what())));
    PyErr_SetObject(instance.type().ptr(), instance.ptr());
  }
}
}  // namespace

NB_MODULE(_core, module) {
  using namespace tetwarp;
  if (PyInterpreterState_GetID(PyInterpreterState_Get()) != 0) {
    throw nb::import_error(
        "tetwarp: sub-interpreters are not supported; import it in the main interpreter or in "
        "another process");
  }
  nb::set_leak_warnings(false);  // daemon threads still hold objects when a process ends
  module.doc() = "The library behind the package tetwarp.";
  module.attr("version") = TETWARP_VERSION;
  const nb::exception<CudaError> cuda_error(module, "CudaError", PyExc_RuntimeError);
  const nb::exception<IoError> io_error(module, "IoError", PyExc_OSError);
  nb::exception<MissingLibrary> missing(module, "MissingLibrary", io_error.ptr());
  missing.attr("library") = "";
  nb::register_exception_translator(&raise_io_error, module.ptr());
  const nb::exception<Cancelled> cancelled(module, "Cancelled", PyExc_RuntimeError);
  module.def("available_backends", &backends, nb::arg("device") = 0,
             "A dict per back end: backend, usable, device, and why it is not usable.");
  python::bind_volume(module);
  python::bind_mesh(module);
  python::bind_warp(module);
  python::bind_operator(module);
  python::bind_resample(module);
  python::bind_compose(module);
  python::bind_files(module);
  python::bind_certify(module);
  python::bind_contact(module);
  python::bind_tracker(module);
  python::bind_simulate(module);
}
