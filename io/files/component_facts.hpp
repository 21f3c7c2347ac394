/// @file component_facts.hpp
/// Entries of VolumeHeader::left_out without which vectors and tensors are something else.
#pragma once

namespace tetwarp {

/// Of NRRD: axes of the components other than those of the space.
inline constexpr const char* frame_fact = "measurement frame";
/// Of NRRD: its own order of six components.
inline constexpr const char* order_fact = "order of the components of a symmetric matrix";

}  // namespace tetwarp
