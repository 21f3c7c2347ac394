/// @file alike_bodies.cpp
/// Compares what the geometry of bodies from images is made of.
#include "host/scene/alike_bodies.hpp"

#include <cstdint>
#include <variant>

namespace tetwarp {

bool are_alike(const Body& a, const Body& b) {
  const auto *of_a = std::get_if<ImageGeometry>(&a.geometry),
             *of_b = std::get_if<ImageGeometry>(&b.geometry);
  if (of_a == nullptr || of_b == nullptr || a.kind != b.kind || a.lattice != b.lattice)
    return false;
  if (std::holds_alternative<Surface>(a.surface) || a.surface.index() != b.surface.index()) {
    return false;
  }
  const auto *count_a = std::get_if<std::int64_t>(&a.surface),
             *count_b = std::get_if<std::int64_t>(&b.surface);
  if (count_a != nullptr && *count_a != *count_b) return false;
  const Volume &volume_a = of_a->volume, &volume_b = of_b->volume;
  return of_a->threshold == of_b->threshold && volume_a.grid == volume_b.grid &&
         volume_a.type == volume_b.type && volume_a.data == volume_b.data;
}

}  // namespace tetwarp
