/// @file vtkhdf_input.cpp
/// Opens a file, checks its type and version, and reads its steps.
#include "io/vtkhdf/vtkhdf_input.hpp"

#include <algorithm>
#include <cmath>
#include <tetwarp/io.hpp>

#include "io/h5/h5_attribute.hpp"
#include "io/h5/h5_read.hpp"

namespace tetwarp {
namespace {
std::string wrong_type(const std::string& found, const std::string& expected) {
  std::string problem = "Type is '" + found + "', expected '" + expected + "'";
  if (found == "UnstructuredGrid" && expected == "ImageData") {
    problem += ": this is a mesh, not a volume; check the order of the files";
  } else if (found == "ImageData" && expected == "UnstructuredGrid") {
    problem += ": this is a volume, not a mesh; check the order of the files";
  }
  return problem;
}

void read_steps(VtkhdfInput& file) {
  file.steps = h5::open_group(file.root, "Steps");
  if (!h5::has_attribute(file.steps, "NSteps")) {
    file.steps.fail("missing attribute NSteps: the file was not finished, write it again");
  }
  const std::int64_t count = h5::read_integer_attribute(file.steps, "NSteps", 1)[0];
  const h5::Dataset values = h5::open_dataset(file.steps, "Values");
  if (count < 1 || count > values.rows()) {
    file.steps.fail("NSteps is " + std::to_string(count) + ", Values has " +
                    std::to_string(values.rows()) + " entries; expected 1 to that many");
  }
  file.times = h5::read_reals(values);
  file.times.resize(static_cast<std::size_t>(count));
  for (std::size_t step = 0; step < file.times.size(); ++step) {
    if (std::isfinite(file.times[step])) continue;
    values.fail("the time of step " + std::to_string(step) + " is " +
                std::to_string(file.times[step]) + ", expected a finite number; correct it");
  }
}

/// Files of a later major version may mean something else by the same names.
void check_version(const h5::Object& root) {
  if (!h5::has_attribute(root, "Version")) return;
  const std::vector<std::int64_t> version = h5::read_integer_attribute(root, "Version", 2);
  if (version[0] <= 2) return;
  root.fail("Version is [" + std::to_string(version[0]) + "," + std::to_string(version[1]) +
            "], expected [1,x] or [2,x]; write the file in one of these versions");
}
}  // namespace

void VtkhdfInput::check_step(std::int64_t step) const {
  const auto last = is_temporal() ? static_cast<std::int64_t>(times.size()) - 1 : 0;
  if (step >= 0 && step <= last) return;
  file.fail("has no step " + std::to_string(step) + ", its steps are " +
            (last == 0 ? "0 alone" : "0 to " + std::to_string(last)));
}

VtkhdfInput open_vtkhdf(const std::string& path, const std::string& type) {
  if (kind_of(path) == FileKind::nifti) throw IoError(path, "", "is an image, not a mesh");
  VtkhdfInput file;
  file.file = h5::open_file(path);
  file.root = h5::open_group(file.file, "VTKHDF");
  if (!h5::has_attribute(file.root, "Type")) {
    file.root.fail("missing attribute Type, expected '" + type + "'");
  }
  const std::string found = h5::read_text_attribute(file.root, "Type");
  if (found != type) file.root.fail(wrong_type(found, type));
  check_version(file.root);
  if (h5::has_child(file.root, "Steps")) read_steps(file);
  return file;
}

std::vector<std::int64_t> read_step_offsets(const VtkhdfInput& file,
                                            const h5::Object& group,
                                            const std::string& name) {
  if (!h5::has_child(group, name)) return {};
  const h5::Dataset dataset = h5::open_dataset(group, name);
  std::vector<std::int64_t> offsets = h5::read_integers(dataset);
  if (offsets.size() < file.times.size()) {
    dataset.fail("has " + std::to_string(offsets.size()) + " entries, expected one for each of " +
                 std::to_string(file.times.size()) + " steps");
  }
  for (std::size_t step = 0; step < file.times.size(); ++step) {
    if (offsets[step] < 0 || offsets[step] > std::int64_t{1} << 60) {
      dataset.fail("entry " + std::to_string(step) + " is " + std::to_string(offsets[step]) +
                   ", expected an offset from 0 to 2^60");
    }
  }
  return offsets;
}

std::vector<std::int64_t> read_point_data_offsets(const VtkhdfInput& file,
                                                  const std::string& array) {
  if (!h5::is_group(file.steps, "PointDataOffsets")) return {};
  return read_step_offsets(file, h5::open_group(file.steps, "PointDataOffsets"), array);
}

std::string active_array(const std::vector<std::string>& names, const std::string& scalars) {
  if (std::ranges::find(names, scalars) != names.end()) return scalars;
  const auto is_image = [](const std::string& name) { return !name.starts_with("tetwarp_"); };
  const auto image = std::ranges::find_if(names, is_image);
  return image == names.end() ? names.front() : *image;
}

}  // namespace tetwarp
