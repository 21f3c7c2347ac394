/// @file foreign_points.cpp
/// Has the program read points, and copy the file with others in their place.
#include "io/points/foreign_points.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <tetwarp/error.hpp>

#include "host/base/point3.hpp"
#include "io/files/extension.hpp"
#include "io/files/finished_file.hpp"
#include "io/import/mesh_child.hpp"

namespace tetwarp {
namespace {
/// Formats of triangles alone.
bool holds_no_arrays(const std::string& path) {
  return has_extension(path, ".stl") || has_extension(path, ".obj") || has_extension(path, ".ply");
}

void write_bytes(const FinishedFile& file,
                 const std::vector<Point3>& points,
                 const std::vector<std::uint8_t>& inside) {
  std::ofstream out(file.temporary(), std::ios::binary);
  out.write(reinterpret_cast<const char*>(points.data()),
            static_cast<std::streamsize>(points.size() * sizeof(Point3)));
  out.write(reinterpret_cast<const char*>(inside.data()),
            static_cast<std::streamsize>(inside.size()));
  if (!out.flush()) {
    throw IoError(file.path(), "", std::string("cannot be written: ") + std::strerror(errno));
  }
}
}  // namespace

ForeignPoints::ForeignPoints(const std::string& path, Axes axes) : path_(path), axes_(axes) {
  points_ = read_points_in_child(path);
  if (points_.empty()) throw IoError(path, "", "holds no point");
  for (Point3& x : points_) x = between(axes, x);
}

std::vector<std::string> ForeignPoints::output_extensions() const {
  if (has_extension(path_, ".vtu")) return {".vtu", ".vtk"};
  if (has_extension(path_, ".vtk")) return {".vtk", ".vtp", ".vtu", ".stl", ".ply", ".obj"};
  return {".vtp", ".vtk", ".stl", ".ply", ".obj"};
}

std::string ForeignPoints::write(const std::string& path, const PlacedPoints& placed) const {
  std::vector<Point3> places(placed.points.size());
  for (std::size_t p = 0; p < places.size(); ++p) places[p] = between(axes_, placed.points[p]);
  const FinishedFile numbers(path + ".points");  // removed at the end, as it is never finished
  write_bytes(numbers, places, placed.inside);
  FinishedFile output(path);
  place_points_in_child(path_, numbers.temporary(), output.temporary());
  output.finish();
  return holds_no_arrays(path) ? "its format has no place for the array inside" : "";
}

}  // namespace tetwarp
