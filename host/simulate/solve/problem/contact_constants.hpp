/// @file contact_constants.hpp
/// The constants of contacts whose own blocks are not known yet, for the two-level iteration.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "kernels/contact/contact_law.hpp"

namespace tetwarp {

struct ContactConstantsList {
  std::vector<ContactConstants<double>> constants;  ///< [contacts] all but block, tangent_metric
  /// [contacts] normal impulse [N s] of a spring at u_n = 0 where its gap is not dt w_n; normal
  /// impulses of the laws are those of the contacts plus it.
  std::vector<double> preload;

  /// @param laws  friction, offsets and adhesion of the contacts
  void set(const ContactProblem& laws);

 private:
  std::vector<std::int32_t> slots_;
};

}  // namespace tetwarp
