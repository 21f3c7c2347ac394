/// @file contact_constants.hpp
/// The constants of contacts whose own blocks are computed later, for the two-level iteration.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "kernels/contact/contact_law.hpp"

namespace tetwarp {

struct ContactConstantsList {
  std::vector<ContactConstants<double>> constants;  ///< [contacts] all but block, tangent_metric
  /// [contacts] impulse [N s] of the normal spring at u_n = 0 if its gap is not dt w_n. The normal
  /// impulse of the law is that of the contact plus this one.
  std::vector<double> preload;

  /// @param laws  friction, offsets and adhesion of the contacts
  void set(const ContactProblem& laws);

 private:
  std::vector<std::int32_t> slots_;
};

}  // namespace tetwarp
