/// @file check_body.hpp
/// Checks of a body, its contact and its adhesion.
#pragma once
#include <string>

#include <tetwarp/scene.hpp>

namespace tetwarp {

void check_body(const std::string& place, const Body& body);
void check_contact(const std::string& place, const SurfaceContact& contact);
void check_adhesion(const std::string& place, const AdhesionMaterial& adhesion);

}  // namespace tetwarp
