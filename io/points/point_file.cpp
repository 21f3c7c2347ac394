/// @file point_file.cpp
/// Chooses the format by the end of the name.
#include <tetwarp/point_file.hpp>

#include <algorithm>

#include "io/files/extension.hpp"
#include "io/files/text_file.hpp"
#include "io/points/foreign_points.hpp"
#include "io/points/markup_points.hpp"
#include "io/points/text_points.hpp"
#include "io/points/vtkhdf_points.hpp"

namespace tetwarp {
namespace {
bool ends_in(const std::string& path, const std::vector<std::string>& extensions) {
  return std::any_of(extensions.begin(), extensions.end(),
                     [&](const std::string& end) { return has_extension(path, end); });
}

std::unique_ptr<PointDocument> open_document(const std::string& path, Axes axes) {
  check_readable(path);
  if (ends_in(path, {".csv", ".tsv", ".txt", ".fcsv"})) {
    return std::make_unique<TextPoints>(path, axes);
  }
  if (ends_in(path, {".json"})) return std::make_unique<MarkupPoints>(path, axes);
  if (ends_in(path, {".vtkhdf", ".hdf", ".h5"})) return std::make_unique<VtkhdfPoints>(path);
  if (ends_in(path, {".stl", ".ply", ".obj", ".vtp", ".vtu", ".vtk"})) {
    return std::make_unique<ForeignPoints>(path, axes);
  }
  throw IoError(path, "",
                "the name of a file of points must end in .csv, .tsv, .txt, .fcsv, .mrk.json, "
                ".vtkhdf, .stl, .ply, .obj, .vtp, .vtu or .vtk");
}
}  // namespace

struct PointFile::State {
  std::unique_ptr<PointDocument> document;
};

PointFile::PointFile(const std::string& path, Axes axes)
    : state_(std::make_unique<State>(State{open_document(path, axes)})) {}
PointFile::PointFile(PointFile&&) noexcept = default;
PointFile::~PointFile() = default;

const std::vector<Point3>& PointFile::points() const {
  return state_->document->points();
}

bool PointFile::takes_axes() const {
  return state_->document->takes_axes();
}

void PointFile::check_output(const std::string& path) const {
  const std::vector<std::string> extensions = state_->document->output_extensions();
  if (ends_in(path, extensions)) return;
  std::string listed;
  for (const std::string& end : extensions) listed += (listed.empty() ? "" : ", ") + end;
  throw IoError(path, "", "points of that file are written under a name that ends in " + listed);
}

std::string PointFile::write(const std::string& path,
                             const std::vector<Point3>& points,
                             const std::vector<std::uint8_t>& inside) const {
  if (points.size() != this->points().size() || inside.size() != points.size()) {
    throw IoError(path, "", "expected as many points as the file has that was read");
  }
  check_output(path);
  return state_->document->write(path, {points, inside});
}

}  // namespace tetwarp
