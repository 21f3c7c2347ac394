/// @file itk_transform.hpp
/// Transforms that ITK writes by type and parameters.
#pragma once
#include <string>
#include <vector>

#include <tetwarp/resample.hpp>

namespace tetwarp {

/// One transform of a file.
struct ItkTransform {
  std::string type;                ///< "AffineTransform_double_3_3"
  std::vector<double> parameters;  ///< numbers that ITK optimizes
  std::vector<double> fixed;       ///< others: a center, or a grid
};

/// The transform of a file, turned from LPS to RAS. A composite applies its last transform first.
/// @throws IoError  when the file holds several without a composite, or one that is not read
Transform transform_of(const std::string& path, const std::vector<ItkTransform>& transforms);

}  // namespace tetwarp
