/// @file transform_links.cpp
/// Checks transforms and makes views of them.
#include "host/warp/cpu/transform_links.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "host/base/index_space.hpp"
#include "host/base/region_grid.hpp"

namespace tetwarp {
namespace {
/// Checks the numbers that a region of a grid needs.
template <class Number>
void check_vectors(const Grid& grid,
                   const Region& region,
                   const std::vector<Number>& vectors,
                   const std::string& what) {
  check_grid(grid, what);
  if (std::ssize(vectors) != 3 * checked_region(grid, region).voxel_count()) {
    throw std::invalid_argument(what + ": expected three numbers for every voxel");
  }
}

bool is_identity(const IndexAffine& map) {
  for (int row = 0; row < 3; ++row) {
    if (map.offset[row] != 0) return false;
    for (int axis = 0; axis < 3; ++axis) {
      if (map.linear[row][axis] != (row == axis ? 1 : 0)) return false;
    }
  }
  return true;
}

struct LinkMaker {
  const FieldWindow* window;  ///< of a field; null: it holds the displacements

  TransformLink operator()(const AffineTransform& affine) const {
    const auto is_finite = [](double x) { return std::isfinite(x); };
    if (!std::ranges::all_of(affine.matrix, is_finite) ||
        !std::ranges::all_of(affine.offset, is_finite)) {
      throw std::invalid_argument("transform: a number is not finite");
    }
    TransformLink link{};
    link.affine = affine_map(affine);
    return link;
  }
  TransformLink operator()(const DisplacementField& field) const {
    const Region region = window != nullptr ? window->region : Region{{0, 0, 0}, field.grid.dims};
    const std::vector<float>& held = window != nullptr ? window->displacement : field.displacement;
    check_vectors(field.grid, region, held, "displacement field");
    TransformLink link{};
    link.to_index = index_from_world(field.grid);
    link.field.vectors = held.data();
    std::ranges::copy(field.grid.dims, link.field.dims);
    std::ranges::copy(grid_of_region(field.grid, region).dims, link.field.size);
    link.field.first = link.field.place(region.begin[0], region.begin[1], region.begin[2]);
    return link;
  }
  TransformLink operator()(const BSplineTransform& spline) const {
    check_vectors(spline.grid, {{0, 0, 0}, spline.grid.dims}, spline.coefficients, "spline");
    if (std::ranges::min(spline.grid.dims) < 4) {
      throw std::invalid_argument(
          "spline: a cubic one has at least 4 coefficients along each axis");
    }
    TransformLink link{};
    link.to_index = index_from_world(spline.grid);
    link.spline.coefficients = spline.coefficients.data();
    std::ranges::copy(spline.grid.dims, link.spline.dims);
    return link;
  }
};
}  // namespace

std::vector<TransformLink> links_of(const Transform& transform,
                                    std::span<const FieldWindow> windows) {
  std::vector<TransformLink> links;
  const auto add = [&](const auto& single) {
    const std::size_t n = links.size();
    if (!windows.empty() && n >= windows.size()) {
      throw std::invalid_argument("transform: expected a window of every link");
    }
    links.push_back(LinkMaker{windows.empty() ? nullptr : &windows[n]}(single));
  };
  if (const auto* const chain = std::get_if<TransformChain>(&transform)) {
    if (chain->links.empty()) throw std::invalid_argument("transform: a chain without links");
    for (const SingleTransform& link : chain->links) std::visit(add, link);
  } else if (const auto* const affine = std::get_if<AffineTransform>(&transform)) {
    add(*affine);
  } else if (const auto* const field = std::get_if<DisplacementField>(&transform)) {
    add(*field);
  } else {
    add(std::get<BSplineTransform>(transform));
  }
  return links;
}

std::vector<TransformLink> folded(const std::vector<TransformLink>& links) {
  std::vector<TransformLink> fewer;
  for (const TransformLink& link : links) {
    if (link.is_affine() && !fewer.empty() && fewer.back().is_affine()) {
      fewer.back().affine = composed(link.affine, fewer.back().affine);
    } else {
      fewer.push_back(link);
    }
    if (fewer.back().is_affine() && is_identity(fewer.back().affine)) fewer.pop_back();
  }
  return fewer;
}

const Grid* first_grid(const Transform& transform) {
  struct {
    const Grid* operator()(const AffineTransform&) const { return nullptr; }
    const Grid* operator()(const DisplacementField& field) const { return &field.grid; }
    const Grid* operator()(const BSplineTransform& spline) const { return &spline.grid; }
    const Grid* operator()(const TransformChain& chain) const {
      for (const SingleTransform& link : chain.links) {
        if (const Grid* const grid = std::visit(*this, link)) return grid;
      }
      return nullptr;
    }
  } find;
  return std::visit(find, transform);
}

IndexAffine composed(const IndexAffine& a, const IndexAffine& b) {
  IndexAffine map;
  a.map(b.offset, map.offset);
  for (int row = 0; row < 3; ++row) {
    for (int axis = 0; axis < 3; ++axis) {
      map.linear[row][axis] = 0;
      for (int n = 0; n < 3; ++n) map.linear[row][axis] += a.linear[row][n] * b.linear[n][axis];
    }
  }
  return map;
}

IndexAffine affine_map(const AffineTransform& affine) {
  IndexAffine map;
  for (std::size_t row = 0; row < 3; ++row) {
    std::copy_n(affine.matrix.begin() + static_cast<std::ptrdiff_t>(3 * row), 3, map.linear[row]);
    map.offset[row] = affine.offset[row];
  }
  return map;
}

IndexAffine world_map(const Grid& grid) {
  IndexAffine map;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      map.linear[row][axis] = grid.direction[3 * row + axis] * grid.spacing[axis];
    }
    map.offset[row] = grid.origin[row];
  }
  return map;
}

IndexAffine index_map(const Grid& grid) {
  const IndexFromWorld from_world = index_from_world(grid);
  IndexAffine map;
  for (int row = 0; row < 3; ++row) {
    map.offset[row] = 0;
    for (int axis = 0; axis < 3; ++axis) {
      map.linear[row][axis] = from_world.linear[row][axis];
      map.offset[row] -= from_world.linear[row][axis] * from_world.origin[axis];
    }
  }
  return map;
}

IndexAffine between_grids(const Grid& other, const Grid& output) {
  const IndexMap map = source_from_output(other, output);
  IndexAffine affine;
  for (std::size_t row = 0; row < 3; ++row) {
    std::copy_n(map.linear.begin() + static_cast<std::ptrdiff_t>(3 * row), 3, affine.linear[row]);
    affine.offset[row] = map.offset[row];
  }
  return affine;
}

}  // namespace tetwarp
