/// @file phantom_torso.hpp
/// The torso phantom.
#pragma once
#include "host/make/phantom_shapes.hpp"

namespace tetwarp {

/// A torso of an adult, somewhat shortened.
Anatomy make_torso();

}  // namespace tetwarp
