/// @file simulate_contacts.cpp
/// Sums of contacts on the points of surfaces, and the file of contacts.
#include "host/cli/simulate/simulate_contacts.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <system_error>
#include <utility>

namespace tetwarp::cli {
namespace {
const std::vector<PointArray>& contact_arrays() {
  static const std::vector<PointArray> arrays{
      {"normal", 3}, {"impulse", 3},      {"intensity"},      {"gap"},
      {"area"},      {"body_a", 1, true}, {"body_b", 1, true}};
  return arrays;
}

bool is_there(const std::string& path) {
  std::error_code error;
  return std::filesystem::exists(path, error);
}

StepPointsWriter writer_of(const std::string& path, bool opens, std::int64_t kept_steps) {
  if (opens) return StepPointsWriter(path, contact_arrays(), kept_steps);
  return StepPointsWriter(path, contact_arrays());
}

std::int32_t nearest_point(const std::vector<Point3>& points, const Point3& to) {
  std::int32_t nearest = -1;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t p = 0; p < points.size(); ++p) {
    double squares = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      squares += (points[p][axis] - to[axis]) * (points[p][axis] - to[axis]);
    }
    if (squares < least) {
      least = squares;
      nearest = static_cast<std::int32_t>(p);
    }
  }
  return nearest;
}

/// Adds contacts to the fields of one body after another.
class FieldSums {
 public:
  explicit FieldSums(const Simulator& simulator) : simulator_(simulator) {
    const std::size_t count = simulator.scene().bodies.size();
    fields_.resize(count);
    positions_.resize(count);
    const double cap = 100 * simulator.thickness();
    for (std::size_t b = 0; b < count; ++b) {
      const std::size_t points = simulator.body(b).surface.points.size();
      fields_[b].impulse.resize(3 * points);
      fields_[b].intensity.resize(points);
      fields_[b].gap.assign(points, cap);
    }
  }

  /// @param sign  of the impulse: 1 on side a, -1 on side b
  void add(const ContactPoint& contact, std::size_t body, ContactPlace place, double sign) {
    if (body >= fields_.size() || fields_[body].gap.empty()) return;
    if (place.point[0] < 0) {
      if (positions_[body].empty()) positions_[body] = simulator_.surface_positions(body);
      place = {{nearest_point(positions_[body], contact.position), -1, -1}, {1, 0, 0}};
    }
    ContactFields& fields = fields_[body];
    for (std::size_t corner = 0; corner < 3 && place.point[corner] >= 0; ++corner) {
      if (place.weight[corner] == 0) continue;
      const auto point = static_cast<std::size_t>(place.point[corner]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        fields.impulse[3 * point + axis] += sign * place.weight[corner] * contact.impulse[axis];
      }
      fields.intensity[point] = std::max(fields.intensity[point], contact.intensity);
      fields.gap[point] = std::min(fields.gap[point], contact.gap);
    }
  }

  std::vector<ContactFields> take() { return std::move(fields_); }

 private:
  const Simulator& simulator_;
  std::vector<ContactFields> fields_;
  std::vector<std::vector<Point3>> positions_;  ///< of surfaces, read when first needed
};
}  // namespace

std::vector<ContactFields> contact_fields(const Simulator& simulator) {
  FieldSums sums(simulator);
  for (const ContactPoint& contact : simulator.contacts()) {
    sums.add(contact, contact.body_a, contact.place_a, 1);
    sums.add(contact, contact.body_b, contact.place_b, -1);
  }
  return sums.take();
}

ContactFile::ContactFile(const std::string& path, std::int64_t kept_steps)
    : is_opened_(kept_steps >= 0 && is_there(path)),
      writer_(writer_of(path, is_opened_, kept_steps)) {}

void ContactFile::drop_later() {
  if (is_opened_) writer_.drop_later();
}

void ContactFile::append(const Simulator& simulator) {
  const std::vector<ContactPoint> contacts = simulator.contacts();
  std::vector<Point3> points;
  std::array<std::vector<double>, 7> values;  // as contact_arrays()
  for (const ContactPoint& contact : contacts) {
    points.push_back(contact.position);
    values[0].insert(values[0].end(), contact.normal.begin(), contact.normal.end());
    values[1].insert(values[1].end(), contact.impulse.begin(), contact.impulse.end());
    values[2].push_back(contact.intensity);
    values[3].push_back(contact.gap);
    values[4].push_back(contact.area);
    values[5].push_back(static_cast<double>(contact.body_a));
    values[6].push_back(static_cast<double>(contact.body_b));
  }
  const std::vector<std::span<const double>> views(values.begin(), values.end());
  writer_.append(simulator.time(), points, views);
}

}  // namespace tetwarp::cli
