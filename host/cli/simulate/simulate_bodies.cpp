/// @file simulate_bodies.cpp
/// Which arrays a file of a body has, and their values.
#include "host/cli/simulate/simulate_bodies.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace tetwarp::cli {
namespace fs = std::filesystem;
namespace {
constexpr std::size_t most_kept_bytes = std::size_t{1} << 26;

std::vector<double> flat(const std::vector<Point3>& points) {
  std::vector<double> numbers;
  numbers.reserve(3 * points.size());
  for (const Point3& point : points) numbers.insert(numbers.end(), point.begin(), point.end());
  return numbers;
}

Point3 cross(const Point3& a, const Point3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Makes `name` in the folder of `target` a link to it; without effect where links cannot be made.
void link_beside(const fs::path& target, const std::string& name) {
  std::error_code error;
  const fs::path link = target.parent_path() / name;
  fs::remove(link, error);
  fs::create_symlink(target.filename(), link, error);
}
}  // namespace

BodyFiles::BodyFiles(Simulator& simulator, const std::string& folder, std::int64_t kept_steps)
    : simulator_(simulator), looks_(simulator) {
  const std::vector<Body>& bodies = simulator.scene().bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyMesh& body = simulator.body(b);
    const fs::path path = fs::path(folder) / (bodies[b].name + ".vtkhdf");
    const std::string surface_name = bodies[b].name + ".surface.vtkhdf";
    const bool has_surface = !body.surface.triangles.empty();
    if (body.mesh.cell_count() > 0) {
      open(b, Points::nodes, path.string(), kept_steps);
      if (!has_surface) continue;
      open(b, Points::surface, (fs::path(folder) / surface_name).string(), kept_steps);
      if (looks_.of(b) == nullptr) continue;
      const std::string look_name = bodies[b].name + ".look.vtkhdf";
      open(b, Points::look, (fs::path(folder) / look_name).string(), kept_steps);
    } else if (has_surface) {
      open(b, Points::surface, path.string(), kept_steps);
      link_beside(path, surface_name);
    }
  }
}

void BodyFiles::open(std::size_t body,
                     Points points,
                     const std::string& path,
                     std::int64_t kept_steps) {
  const std::vector<StepArray> arrays = arrays_of(body, points);
  paths_.push_back(path);
  const BodyMesh& mesh = simulator_.body(body);
  const Surface& surface = points == Points::look ? *looks_.of(body) : mesh.surface;
  if (kept_steps >= 0) {
    const std::size_t count =
        points == Points::nodes ? mesh.mesh.rest_positions.size() : surface.points.size();
    files_.push_back({body, points, arrays, StepMeshWriter(path, count, arrays, kept_steps)});
    return;
  }
  std::error_code error;
  if (fs::is_symlink(path, error)) fs::remove(path, error);  // of an earlier run in this folder
  files_.push_back({body, points, arrays,
                    points == Points::nodes ? StepMeshWriter(path, mesh.mesh, arrays)
                                            : StepMeshWriter(path, surface, arrays)});
}

bool BodyFiles::has_field(const std::string& name) const {
  return std::ranges::count(simulator_.scene().output.fields, name) > 0;
}

std::vector<StepArray> BodyFiles::arrays_of(std::size_t body, Points points) const {
  std::vector<StepArray> arrays{{"displacement", false, 3}};
  if (points == Points::look) return arrays;
  const BodyMesh& mesh = simulator_.body(body);
  const bool is_rigid = mesh.kind == BodyKind::rigid;
  const bool has_velocities = points == Points::nodes || is_rigid ||
                              simulator_.node_velocities(body).size() == mesh.surface.points.size();
  if (has_field("velocity") && has_velocities) arrays.push_back({"velocity", false, 3});
  if (points == Points::surface && has_field("contact")) {
    arrays.insert(arrays.end(),
                  {{"impulse", false, 3}, {"intensity", false, 1}, {"gap", false, 1}});
  }
  if (points == Points::nodes && has_field("stress")) arrays.push_back({"stress", true, 1});
  if (points == Points::nodes && has_field("jacobian")) arrays.push_back({"jacobian", true, 1});
  return arrays;
}

std::vector<Point3> BodyFiles::velocities_of(const File& file) const {
  if (simulator_.body(file.body).kind != BodyKind::rigid) {
    return simulator_.node_velocities(file.body);
  }
  const BodyRecord& body = simulator_.record().bodies.at(file.body);
  std::vector<Point3> velocities = simulator_.surface_positions(file.body);
  for (Point3& point : velocities) {
    Point3 arm{};
    for (std::size_t axis = 0; axis < 3; ++axis) arm[axis] = point[axis] - body.center[axis];
    const Point3 turning = cross(body.angular_velocity, arm);
    for (std::size_t axis = 0; axis < 3; ++axis) point[axis] = body.velocity[axis] + turning[axis];
  }
  return velocities;
}

std::vector<double> BodyFiles::values_of(const File& file, const StepArray& array) const {
  if (array.name == "velocity") return flat(velocities_of(file));
  if (array.name == "stress") return simulator_.cell_stresses(file.body);
  if (array.name == "impulse") return contacts_.at(file.body).impulse;
  if (array.name == "intensity") return contacts_.at(file.body).intensity;
  if (array.name == "gap") return contacts_.at(file.body).gap;
  if (array.name == "jacobian") return simulator_.cell_jacobians(file.body);
  const std::vector<Point3>& points = rest_points(file);
  std::vector<double> values = flat(positions_of(file));
  for (std::size_t p = 0; p < points.size(); ++p) {
    for (std::size_t axis = 0; axis < 3; ++axis) values[3 * p + axis] -= points[p][axis];
  }
  return values;
}

const std::vector<Point3>& BodyFiles::rest_points(const File& file) const {
  if (file.points == Points::look) return looks_.of(file.body)->points;
  const BodyMesh& mesh = simulator_.body(file.body);
  return file.points == Points::nodes ? mesh.mesh.rest_positions : mesh.surface.points;
}

std::vector<Point3> BodyFiles::positions_of(const File& file) const {
  if (file.points == Points::look) return looks_.positions(file.body);
  return file.points == Points::nodes ? simulator_.node_positions(file.body)
                                      : simulator_.surface_positions(file.body);
}

void BodyFiles::drop_later() {
  for (File& file : files_) file.writer.drop_later();
}

void BodyFiles::append() {
  if (has_field("contact")) contacts_ = contact_fields(simulator_);
  for (File& file : files_) {
    std::vector<std::vector<double>> values;
    values.reserve(file.arrays.size());
    for (const StepArray& array : file.arrays) values.push_back(values_of(file, array));
    const std::vector<std::span<const double>> views(values.begin(), values.end());
    file.writer.append(simulator_.time(), views);
    for (const std::vector<double>& own : values) kept_bytes_ += own.size() * sizeof(double);
    if (kept_bytes_ > most_kept_bytes) flush();
  }
}

void BodyFiles::flush() {
  for (File& file : files_) file.writer.flush();
  kept_bytes_ = 0;
}

}  // namespace tetwarp::cli
