/// @file method_names.hpp
/// Names of methods in reports and benchmark rows.
#pragma once
#include <tetwarp/contact.hpp>

namespace tetwarp {

/// The enumerator's own name, e.g. "gauss_seidel". The command's option takes the shorter words of
/// names_of<ContactMethod>().
constexpr const char* report_name_of(ContactMethod method) {
  switch (method) {
    case ContactMethod::automatic:
      return "automatic";
    case ContactMethod::gauss_seidel:
      return "gauss_seidel";
    case ContactMethod::nonlinear_cg:
      return "nonlinear_cg";
    case ContactMethod::anderson:
      return "anderson";
    case ContactMethod::newton:
      return "newton";
  }
  return "";
}

}  // namespace tetwarp
