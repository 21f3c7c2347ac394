/// @file markup_points.hpp
/// Landmarks, curves and other markups of 3D Slicer as JSON.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/points/point_document.hpp"

namespace tetwarp {

class MarkupPoints : public PointDocument {
 public:
  /// @throws IoError  as PointFile
  MarkupPoints(const std::string& path, Axes axes);

  const std::vector<Point3>& points() const override { return points_; }
  bool takes_axes() const override { return !names_axes_; }
  std::vector<std::string> output_extensions() const override { return {".json"}; }
  std::string write(const std::string& path, const PlacedPoints& placed) const override;

 private:
  Axes axes_of(const nlohmann::ordered_json& markup, const std::string& place) const;

  std::string path_;
  nlohmann::ordered_json root_;  // keys keep their order
  Axes axes_;
  bool names_axes_ = true;  // every markup
  std::vector<Point3> points_;
};

}  // namespace tetwarp
