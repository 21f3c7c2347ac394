/// @file point_document.hpp
/// A file whose points are read, and copied with others in their place.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/axes.hpp>
#include <tetwarp/volume.hpp>

namespace tetwarp {

/// Points with new places.
struct PlacedPoints {
  const std::vector<Point3>& points;        ///< in RAS, as PointDocument::points()
  const std::vector<std::uint8_t>& inside;  ///< 0: the place of the file is kept
};

/// One per format.
class PointDocument {
 public:
  virtual ~PointDocument() = default;

  /// In RAS.
  virtual const std::vector<Point3>& points() const = 0;
  /// Whether the choice of axes matters.
  virtual bool takes_axes() const = 0;
  /// Ends of the names that it can be written under.
  virtual std::vector<std::string> output_extensions() const = 0;
  /// As of PointFile::write().
  virtual std::string write(const std::string& path, const PlacedPoints& placed) const = 0;
};

/// Between RAS and LPS.
inline Point3 turned(const Point3& x) {
  return {0 - x[0], 0 - x[1], x[2]};
}
inline Point3 between(Axes axes, const Point3& x) {
  return axes == Axes::lps ? turned(x) : x;
}

}  // namespace tetwarp
