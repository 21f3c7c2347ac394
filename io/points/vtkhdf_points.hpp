/// @file vtkhdf_points.hpp
/// Points of VTKHDF files without steps.
#pragma once
#include <string>
#include <vector>

#include "io/points/point_document.hpp"

namespace tetwarp {

class VtkhdfPoints : public PointDocument {
 public:
  /// @throws IoError  as PointFile
  explicit VtkhdfPoints(const std::string& path);

  const std::vector<Point3>& points() const override { return points_; }
  bool takes_axes() const override { return false; }
  std::vector<std::string> output_extensions() const override { return {".vtkhdf", ".hdf", ".h5"}; }
  std::string write(const std::string& path, const PlacedPoints& placed) const override;

 private:
  std::string path_;
  std::vector<Point3> points_;
};

}  // namespace tetwarp
