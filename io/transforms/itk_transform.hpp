/// @file itk_transform.hpp
/// Transforms that ITK writes by type and parameters.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <tetwarp/transform_file.hpp>

namespace tetwarp {

/// One transform of a file, whose numbers are finite.
struct ItkTransform {
  std::string type;                ///< "AffineTransform_double_3_3"
  std::vector<double> parameters;  ///< numbers that ITK optimizes
  std::vector<double> fixed;       ///< others: a center, or a grid

  /// Of a field in an HDF5 file, whose parameters stay there: their number, and what reads `count`
  /// of them from `first` on.
  std::int64_t stored = 0;
  std::function<std::vector<double>(std::int64_t first, std::int64_t count)> read = {};
  double chunk_bytes = 0;  ///< memory that this takes beside
};

/// "AffineTransform" of the type "AffineTransform_double_3_3".
std::string itk_class(const std::string& type);

/// @param what      of which there are `count`: "parameters"
/// @throws IoError  when these are not as many as expected
void check_itk_count(const std::string& path,
                     const std::string& type,
                     std::size_t count,
                     std::size_t expected,
                     const char* what);

/// Whether a type is that of a displacement field.
bool is_itk_field(const std::string& type);

/// The transform of a file, turned from LPS and millimeters to a world, without a convention. A
/// composite applies its last transform first. Transforms of two dimensions are lifted() to three.
/// @param world     itk_factor() of the world
/// @throws IoError  when the file holds several without a composite, or one that is not read
TransformParts transform_of(const std::string& path,
                            const std::vector<ItkTransform>& transforms,
                            const Point3& world);

}  // namespace tetwarp
