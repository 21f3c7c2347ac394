/// @file text.hpp
/// Texts of files, which may be in another encoding than UTF-8: bytes that are none become
/// surrogates, as in names of files of Python, and are the same bytes again when they are written.
#pragma once
#include <nanobind/nanobind.h>

#include <cstddef>
#include <stdexcept>
#include <string>

namespace tetwarp::python {

inline nanobind::object text_of(const std::string& bytes) {
  PyObject* const text =
      PyUnicode_DecodeUTF8(bytes.data(), static_cast<Py_ssize_t>(bytes.size()), "surrogateescape");
  if (text == nullptr) throw nanobind::python_error();
  return nanobind::steal(text);
}

/// @param name  for the message
/// @throws std::invalid_argument  it is no text, or has a zero, which would end it in a file
inline std::string bytes_of(nanobind::handle text, const std::string& name) {
  PyObject* const made = PyUnicode_Check(text.ptr())
                             ? PyUnicode_AsEncodedString(text.ptr(), "utf-8", "surrogateescape")
                             : nullptr;
  if (made != nullptr) {
    const auto bytes = nanobind::steal<nanobind::bytes>(made);
    std::string all(bytes.c_str(), bytes.size());
    if (all.find('\0') == std::string::npos) return all;
  }
  PyErr_Clear();
  throw std::invalid_argument(name + ": expected a text of Unicode without zeros");
}

}  // namespace tetwarp::python
