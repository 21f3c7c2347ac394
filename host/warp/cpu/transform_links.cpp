/// @file transform_links.cpp
/// Checks transforms and makes views of them.
#include "host/warp/cpu/transform_links.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "host/base/index_space.hpp"

namespace tetwarp {
namespace {
/// Checks the numbers that a grid needs.
template <class Number>
void check_vectors(const Grid& grid, const std::vector<Number>& vectors, const std::string& what) {
  check_grid(grid, what);
  if (std::ssize(vectors) != 3 * grid.voxel_count()) {
    throw std::invalid_argument(what + ": expected three numbers for every voxel");
  }
}

struct LinkMaker {
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
    check_vectors(field.grid, field.displacement, "displacement field");
    TransformLink link{};
    link.to_index = index_from_world(field.grid);
    link.field.vectors = field.displacement.data();
    std::ranges::copy(field.grid.dims, link.field.dims);
    return link;
  }
  TransformLink operator()(const BSplineTransform& spline) const {
    check_vectors(spline.grid, spline.coefficients, "spline");
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

std::vector<TransformLink> links_of(const Transform& transform) {
  std::vector<TransformLink> links;
  if (const auto* const chain = std::get_if<TransformChain>(&transform)) {
    if (chain->links.empty()) throw std::invalid_argument("transform: a chain without links");
    for (const SingleTransform& link : chain->links) links.push_back(std::visit(LinkMaker{}, link));
  } else if (const auto* const affine = std::get_if<AffineTransform>(&transform)) {
    links.push_back(LinkMaker{}(*affine));
  } else if (const auto* const field = std::get_if<DisplacementField>(&transform)) {
    links.push_back(LinkMaker{}(*field));
  } else {
    links.push_back(LinkMaker{}(std::get<BSplineTransform>(transform)));
  }
  return links;
}

IndexAffine affine_map(const AffineTransform& affine) {
  IndexAffine map;
  for (std::size_t row = 0; row < 3; ++row) {
    std::copy_n(affine.matrix.begin() + static_cast<std::ptrdiff_t>(3 * row), 3, map.linear[row]);
    map.offset[row] = affine.offset[row];
  }
  return map;
}

}  // namespace tetwarp
