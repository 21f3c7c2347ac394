/// @file vtkhdf_volume.cpp
/// Reading VTKHDF ImageData, static and temporal.
#include "io/vtkhdf/vtkhdf_volume.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tetwarp/io.hpp>
#include <utility>

#include "io/files/volume_source.hpp"
#include "io/h5/h5.hpp"
#include "io/h5/h5_attribute.hpp"
#include "io/h5/h5_read.hpp"
#include "io/nifti/nifti_facts.hpp"
#include "io/vtkhdf/vtkhdf_array.hpp"
#include "io/vtkhdf/vtkhdf_input.hpp"

namespace tetwarp {
namespace {
Grid read_grid(const h5::Object& root) {
  const std::vector<std::int64_t> extent = h5::read_integer_attribute(root, "WholeExtent", 6);
  const std::vector<double> origin = h5::read_real_attribute(root, "Origin", 3);
  const std::vector<double> spacing = h5::read_real_attribute(root, "Spacing", 3);
  Grid grid;
  Point3 start;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid.dims[axis] = extent[2 * axis + 1] - extent[2 * axis] + 1;
    grid.origin[axis] = origin[axis];
    grid.spacing[axis] = spacing[axis];
    start[axis] = static_cast<double>(extent[2 * axis]);
  }
  if (h5::has_attribute(root, "Direction")) {
    const std::vector<double> direction = h5::read_real_attribute(root, "Direction", 9);
    std::copy(direction.begin(), direction.end(), grid.direction.begin());
  }
  try {
    check_grid(grid, "grid");
    grid.origin = grid.world_of(start);
    check_grid(grid, "grid");
  } catch (const std::invalid_argument& error) {
    root.fail(std::string(error.what()) + "; correct WholeExtent, Origin, Spacing or Direction");
  }
  return grid;
}

std::string shape_text(const std::vector<std::int64_t>& dims) {
  std::string text;
  for (const std::int64_t dim : dims) text.append("[").append(std::to_string(dim)).append("]");
  return text;
}

/// One point array: [z][y][x], if temporal with time as first axis, with components as last axis if
/// there are several. Axes of one sample may be left out.
struct StoredArray {
  h5::Dataset dataset;
  ArrayHeader header;
  std::vector<std::size_t> axes = {2, 1, 0};  ///< of the dataset
  bool has_component_axis = false;
};

StoredArray open_array(const VtkhdfInput& file, const Grid& grid, const std::string& name) {
  const h5::Object point_data = h5::open_group(file.root, "PointData");
  StoredArray array;
  array.dataset = h5::open_dataset(point_data, name);
  array.header.name = name;
  array.header.type = h5::pixel_type_of(array.dataset);
  array.header.nifti = read_fact_attributes(array.dataset);

  const auto shape_of = [&](const std::vector<std::size_t>& axes) {
    std::vector<std::int64_t> shape;
    if (file.is_temporal()) shape.push_back(array.dataset.rows());
    for (const std::size_t axis : axes) shape.push_back(grid.dims[axis]);
    return shape;
  };
  std::vector<std::int64_t> found = array.dataset.dims, shape = shape_of(array.axes);
  const std::vector<std::int64_t> whole = shape;
  // Axes of one sample are left out: by VTK 9.3 all of them, before z alone.
  std::vector<std::vector<std::size_t>> choices{array.axes,
                                                axes_in_file(grid.dims, file.is_temporal())};
  if (grid.dims[2] == 1) choices.push_back({1, 0});
  for (const std::vector<std::size_t>& axes : choices) {
    const std::vector<std::int64_t> own = shape_of(axes);
    const bool fits = own.size() <= found.size() && found.size() <= own.size() + 1 &&
                      std::equal(own.begin(), own.end(), found.begin());
    if (!fits) continue;
    array.axes = axes;
    shape = own;
    break;
  }
  if (found.size() == shape.size() + 1) {
    const std::int64_t components = found.back();
    if (components < 1 || components > 9) {
      array.dataset.fail("has " + std::to_string(components) + " components, expected 1 to 9");
    }
    array.header.components = static_cast<int>(components);
    array.has_component_axis = true;
    found.pop_back();
  }
  if (found != shape) {
    array.dataset.fail("has shape " + shape_text(array.dataset.dims) + ", expected " +
                       shape_text(whole) +
                       (file.is_temporal() ? " ([t][z][y][x])" : " ([z][y][x])") +
                       ", optionally with components; correct WholeExtent or the data");
  }
  return array;
}

/// @param others  out, may be null: names of what is no array of numbers
std::vector<std::string> numeric_arrays(const VtkhdfInput& file,
                                        std::vector<std::string>* others = nullptr) {
  const h5::Object point_data = h5::open_group(file.root, "PointData");
  std::vector<std::string> names;
  for (const std::string& name : h5::child_names_as_created(point_data)) {
    if (!h5::is_group(point_data, name) && h5::is_numeric(h5::open_dataset(point_data, name))) {
      names.push_back(name);
    } else if (others != nullptr) {
      others->push_back(name);
    }
  }
  if (names.empty()) point_data.fail("holds no array of numbers");
  return names;
}

/// VolumeHeader::not_read, from the names in PointData that are no arrays of numbers.
std::vector<std::string> not_read(const VtkhdfInput& file,
                                  const std::vector<std::string>& point_names) {
  std::vector<std::string> paths;
  paths.reserve(point_names.size());
  for (const std::string& name : point_names) paths.push_back("PointData/" + name);
  const auto others = paths_in(file, {"CellData", "FieldData"}, [](const auto&) { return false; });
  paths.insert(paths.end(), others.begin(), others.end());
  return paths;
}

/// Whether an array is the active scalars, in the way of VTKHDF 2.6.
bool is_marked(const h5::Dataset& array) {
  try {
    return h5::has_attribute(array, "Attribute") &&
           h5::read_text_attribute(array, "Attribute") == "Scalars";
  } catch (const IoError&) {
    return false;
  }
}

/// VolumeHeader::active of the numeric arrays of a file. An attribute that is no text names none.
std::string active_of(const VtkhdfInput& file, const std::vector<std::string>& names) {
  const h5::Object point_data = h5::open_group(file.root, "PointData");
  std::string scalars;
  try {
    if (h5::has_attribute(point_data, "Scalars")) {
      scalars = h5::read_text_attribute(point_data, "Scalars");
    }
  } catch (const IoError&) {
    scalars.clear();
  }
  for (std::size_t n = 0; scalars.empty() && n < names.size(); ++n) {
    const h5::Dataset array = h5::open_dataset(point_data, names[n]);
    if (is_marked(array)) scalars = names[n];
  }
  return active_array(names, scalars);
}

/// The row of the time axis that holds a step of an array.
std::int64_t time_row(const VtkhdfInput& file, const StoredArray& array, std::int64_t step) {
  const std::vector<std::int64_t> offsets = read_point_data_offsets(file, array.header.name);
  const std::int64_t row = offsets.empty() ? step : offsets[static_cast<std::size_t>(step)];
  if (row >= array.dataset.rows()) {
    array.dataset.fail("step " + std::to_string(step) + " is row " + std::to_string(row) +
                       ", but there are " + std::to_string(array.dataset.rows()) + " rows");
  }
  return row;
}
class VtkhdfSource : public VolumeSource {
 public:
  VtkhdfSource(const std::string& path, const std::string& array, std::int64_t step)
      : file_(open_vtkhdf(path, "ImageData")), grid_(read_grid(file_.root)) {
    file_.check_step(step);
    source_ =
        open_array(file_, grid_, array.empty() ? active_of(file_, numeric_arrays(file_)) : array);
    if (file_.is_temporal()) row_ = time_row(file_, source_, step);
  }

  const Grid& grid() const override { return grid_; }
  const ArrayHeader& array() const override { return source_.header; }
  std::vector<std::string> array_names() const override { return numeric_arrays(file_); }
  double chunk_bytes() const override { return 2 * h5::chunk_bytes(source_.dataset); }

  void read(const Region& region, void* samples) override {
    const h5::Dataset& dataset = source_.dataset;
    std::vector<std::int64_t> start, count;
    if (file_.is_temporal()) {
      start.push_back(row_);
      count.push_back(1);
    }
    const bool has_components = source_.has_component_axis;
    for (const std::size_t axis : source_.axes) {
      start.push_back(region.begin[axis]);
      count.push_back(region.end[axis] - region.begin[axis]);
    }
    if (has_components) {
      start.push_back(0);
      count.push_back(source_.header.components);
    }
    h5::read_block(dataset, h5::memory_type_of(array().type), start, count, samples);
  }

 private:
  VtkhdfInput file_;
  Grid grid_;
  StoredArray source_;
  std::int64_t row_ = 0;  ///< of the time axis
};
}  // namespace

VolumeHeader read_vtkhdf_header(const std::string& path) {
  const VtkhdfInput file = open_vtkhdf(path, "ImageData");
  VolumeHeader header;
  header.grid = read_grid(file.root);
  header.times = file.times;
  std::vector<std::string> others;
  const std::vector<std::string> names = numeric_arrays(file, &others);
  header.active = active_of(file, names);
  for (const std::string& name : names) {
    const StoredArray array = open_array(file, header.grid, name);
    header.arrays.push_back(array.header);
    const h5::Dataset& dataset = array.dataset;
    if (dataset.type_class == H5T_FLOAT && dataset.type_size < 4) header.widened.push_back(name);
  }
  header.not_read = not_read(file, others);
  return header;
}

std::unique_ptr<VolumeSource> open_vtkhdf_source(const std::string& path,
                                                 const std::string& array,
                                                 std::int64_t step) {
  return std::make_unique<VtkhdfSource>(path, array, step);
}

}  // namespace tetwarp
