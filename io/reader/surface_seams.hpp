/// @file surface_seams.hpp
/// Seams of surfaces in formats that give each side of a seam, or each triangle, points of its own.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include <tetwarp/volume.hpp>

namespace tetwarp {

/// Joins points that are equal bit by bit and lie on edges of a single triangle: both sides of a
/// seam get the first of them. Elsewhere points stay apart. Points keep their numbers.
void join_seams(const std::vector<Point3>& points,
                std::vector<std::array<std::int32_t, 3>>& triangles);

}  // namespace tetwarp
