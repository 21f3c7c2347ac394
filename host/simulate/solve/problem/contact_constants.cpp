/// @file contact_constants.cpp
/// Runs the stage that sets constants, contact by contact.
#include "host/simulate/solve/problem/contact_constants.hpp"

#include <numeric>

#include "host/base/vector_view.hpp"
#include "kernels/contact/contact_fill.hpp"

namespace tetwarp {
void ContactConstantsList::set(const ContactProblem& laws) {
  const AdhesionState& adhesion = laws.adhesion;
  const std::size_t count = laws.friction.size();
  slots_.resize(count);
  std::iota(slots_.begin(), slots_.end(), 0);
  constants.resize(count);
  ContactInput input;
  input.friction = view_of(laws.friction);
  input.has_adhesion = true;
  input.time_step = adhesion.time_step;
  input.area = view_of(adhesion.area);
  input.stiffness = view_of(adhesion.stiffness);
  input.tangential_stiffness = view_of(adhesion.tangential_stiffness);
  input.intensity = view_of(adhesion.intensity);
  input.gap = view_of(adhesion.gap);
  const ContactConstantsOp op{
      input, view_of(slots_), {}, {constants.data(), static_cast<std::int64_t>(count)}};
  preload.resize(count);
  for (std::size_t c = 0; c < count; ++c) {
    op(static_cast<std::int64_t>(c));
    preload[c] = constants[c].normal_spring *
                 (adhesion.gap[3 * c] / adhesion.time_step - laws.velocity_offset[3 * c]);
  }
}

}  // namespace tetwarp
