/// @file two_level_start.hpp
/// TwoLevelStart: the contacts of a two-level iteration, and what it starts from.
#pragma once
#include <span>
#include <vector>

#include "host/simulate/solve/problem/contact_constants.hpp"
#include "host/simulate/solve/problem/soft_problem.hpp"
#include "host/simulate/solve/two_level/compliant_lists.hpp"
#include "host/simulate/step/cpu/rest_factors.hpp"
#include "kernels/body/contact_arms.hpp"

namespace tetwarp {

struct TwoLevelStart {
  double time_step = 0;                ///< [s]
  std::vector<double> rotation;        ///< R of the elastic bodies, [frames][9], rows first
  std::vector<ContactSides> contacts;  ///< that are solved
  ContactConstantsList laws;           ///< of the contacts
  std::vector<double> offset;          ///< w, [3 contacts]
  std::vector<double> impulse;         ///< guess of r, preload included, [3 contacts]
  std::vector<double> change;  ///< added to the velocities without contact, [rows][3]; or empty

  /// @param factors  of the elastic bodies; are set to the length of the step
  void set(const SoftProblem& problem, const CompliantLists& lists, RestFactors& factors);
  /// Takes the preload off impulses, and copies velocities of rows to their blocks.
  /// @param of_rows   [rows][3]
  /// @param impulse   in and out, [3 contacts]
  /// @param velocity  out in the rows of the lists, [block_count]
  void finish(const CompliantLists& lists,
              std::span<const double> of_rows,
              std::vector<double>& impulse,
              std::vector<Point3>& velocity) const;
};

}  // namespace tetwarp
