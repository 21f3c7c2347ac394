/// @file foreign_points.hpp
/// Points of files that VTK reads and writes, in the program tetwarp-read.
#pragma once
#include <string>
#include <vector>

#include "io/points/point_document.hpp"

namespace tetwarp {

class ForeignPoints : public PointDocument {
 public:
  /// @throws IoError  as PointFile
  ForeignPoints(const std::string& path, Axes axes);

  const std::vector<Point3>& points() const override { return points_; }
  bool takes_axes() const override { return true; }
  std::vector<std::string> output_extensions() const override;
  std::string write(const std::string& path, const PlacedPoints& placed) const override;

 private:
  std::string path_;
  Axes axes_;
  std::vector<Point3> points_;
};

}  // namespace tetwarp
