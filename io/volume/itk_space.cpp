/// @file itk_space.cpp
/// Units and forms as ITK takes them.
#include <tetwarp/itk_space.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "io/child/image_kind.hpp"
#include "io/nifti/nifti_header.hpp"

namespace tetwarp {

Point3 itk_factor(const NiftiFacts& facts) {
  const double unit = nifti_length_unit(facts.xyzt_units);
  const bool has_form = facts.sform_code > 0 || facts.qform_code > 0;
  return {has_form ? unit : -unit, has_form ? unit : -unit, unit};
}

std::optional<Point3> itk_factor(const std::string& path, const VolumeHeader& header) {
  if (const std::optional<NiftiFacts> facts = first_facts(header)) return itk_factor(*facts);
  if (kind_of(path) != FileKind::image || (is_foreign_image(path) && !is_dicom(path))) {
    return std::nullopt;
  }
  return Point3{1, 1, 1};
}

std::optional<NiftiFacts> first_facts(const VolumeHeader& header) {
  const auto array = std::ranges::find_if(
      header.arrays, [](const ArrayHeader& one) { return one.nifti.has_value(); });
  return array == header.arrays.end() ? std::nullopt : array->nifti;
}

bool has_component_axes(const std::string& path) {
  const FileKind kind = kind_of(path);
  return kind == FileKind::nifti || (kind == FileKind::image && !is_foreign_image(path));
}

Point3 ratio(const Point3& from, const Point3& to) {
  return {from[0] / to[0], from[1] / to[1], from[2] / to[2]};
}

Grid scaled(Grid grid, const Point3& factor) {
  if (factor == Point3{1, 1, 1}) return grid;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid.origin[axis] = 0 + factor[axis] * grid.origin[axis];
    grid.spacing[axis] *= std::abs(factor[axis]);
    for (std::size_t n = 0; n < 3; ++n) {
      double& direction = grid.direction[3 * axis + n];
      if (factor[axis] < 0) direction = 0 - direction;
    }
  }
  return grid;
}

}  // namespace tetwarp
