/// @file alike_bodies.hpp
/// Bodies whose geometry need not be made twice.
#pragma once
#include <tetwarp/scene.hpp>

namespace tetwarp {

/// Whether two bodies are made of the same image in the same way, so that their parts are equal
/// before selections.
bool are_alike(const Body& a, const Body& b);

}  // namespace tetwarp
