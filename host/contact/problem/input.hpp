/// @file input.hpp
/// The numbers of a contact problem as the stage "setup" reads them.
#pragma once
#include <tetwarp/contact_problem.hpp>

#include "host/base/index_of.hpp"
#include "host/base/vector_view.hpp"
#include "kernels/contact/contact_fill.hpp"

namespace tetwarp {

/// Views of the problem's own memory, valid while the problem exists and is not changed.
inline ContactInput input_of(const ContactProblem& problem) {
  ContactInput in;
  const bool is_local = problem.is_local();
  in.matrix = view_of(is_local ? problem.delassus.value : problem.system.value);
  in.jacobian = view_of(problem.jacobian.value);
  in.load = view_of(problem.load);
  in.given_velocity = view_of(is_local ? problem.free_velocity : problem.velocity_offset);
  in.friction = view_of(problem.friction);
  const AdhesionState& adhesion = problem.adhesion;
  in.has_adhesion = !adhesion.empty();
  in.time_step = adhesion.time_step;
  in.area = view_of(adhesion.area);
  in.stiffness = view_of(adhesion.stiffness);
  in.tangential_stiffness = view_of(adhesion.tangential_stiffness);
  in.intensity = view_of(adhesion.intensity);
  in.gap = view_of(adhesion.gap);
  in.row_kind = view_of(problem.expert.row_blocks.kind);
  in.row_contact = view_of(problem.expert.row_blocks.contact);
  in.torsion = view_of(problem.expert.row_blocks.torsion);
  return in;
}

}  // namespace tetwarp
