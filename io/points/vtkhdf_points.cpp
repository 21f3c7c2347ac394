/// @file vtkhdf_points.cpp
/// Reads the dataset Points, and copies the file with another one.
#include "io/points/vtkhdf_points.hpp"

#include <array>
#include <cstdint>
#include <tetwarp/error.hpp>

#include "io/h5/h5_attribute.hpp"
#include "io/h5/h5_output.hpp"
#include "io/h5/h5_read.hpp"
#include "io/h5/h5_write.hpp"

namespace tetwarp {
namespace {
h5::Dataset open_points(const h5::Object& root) {
  h5::Dataset points = h5::open_dataset(root, "Points");
  if (points.dims.size() != 2 || points.dims[1] != 3 || !h5::is_numeric(points)) {
    points.fail("expected three numbers for every point");
  }
  return points;
}
}  // namespace

VtkhdfPoints::VtkhdfPoints(const std::string& path) : path_(path) {
  const h5::Silence silence;
  const h5::Object root = h5::open_group(h5::open_file(path), "VTKHDF");
  const std::string type =
      h5::has_attribute(root, "Type") ? h5::read_text_attribute(root, "Type") : "";
  if (type != "UnstructuredGrid" && type != "PolyData") {
    root.fail("Type is '" + type + "', expected UnstructuredGrid or PolyData, which have points");
  }
  if (h5::has_child(root, "Steps")) {
    root.fail("has steps; write the points of one step to a file of its own");
  }
  const h5::Dataset points = open_points(root);
  const std::int64_t count = points.rows();
  if (count == 0) points.fail("holds no point");
  h5::check_memory(path, points.name, 24.0 * static_cast<double>(count));
  points_.resize(static_cast<std::size_t>(count));
  const std::array<std::int64_t, 2> start{0, 0}, size{count, 3};
  h5::read_block(points, H5T_NATIVE_DOUBLE, start, size, points_[0].data());
}

std::string VtkhdfPoints::write(const std::string& path, const PlacedPoints& placed) const {
  const h5::Silence silence;
  h5::OutputFile output(path, path_);
  output.remove("VTKHDF/PointData/inside");
  {
    const h5::Object root = h5::open_group(output.file(), "VTKHDF");
    const h5::Dataset points = open_points(root);
    if (points.rows() != static_cast<std::int64_t>(placed.points.size())) {
      points.fail("has changed since it was read");
    }
    if (H5Dwrite(points.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                 placed.points[0].data()) < 0) {
      points.fail_with_reason("cannot be written");
    }
    const h5::Object arrays = h5::has_child(root, "PointData")
                                  ? h5::open_group(root, "PointData")
                                  : h5::create_group(root, "PointData");
    const std::array<hsize_t, 1> dims{placed.inside.size()};
    h5::write_dataset(arrays, "inside", H5T_STD_U8LE, H5T_NATIVE_UINT8, dims, placed.inside.data());
  }
  output.finish();
  return {};
}

}  // namespace tetwarp
