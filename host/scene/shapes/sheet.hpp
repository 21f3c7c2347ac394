/// @file sheet.hpp
/// Cloth sheets as nodes and triangles.
#pragma once
#include <string>

#include <tetwarp/scene.hpp>

namespace tetwarp {

/// Nodes [v][u], u fastest; two triangles a square, all along the same diagonal, so that every
/// inner node has the same area; their normals point along axes[0] x axes[1].
/// @param place  of the sheet, for messages
/// @throws std::invalid_argument  too many squares
Surface make_sheet(const std::string& place, const Sheet& sheet);

}  // namespace tetwarp
