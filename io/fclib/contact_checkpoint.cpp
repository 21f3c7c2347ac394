/// @file contact_checkpoint.cpp
/// /tetwarp_checkpoint with attributes `version`, `step`, `time`, vectors of the bodies, and a
/// group `contacts` with one vector per member of ContactRecord. Version 1 is without `standoff`,
/// `normal_world` and the material points.
#include <algorithm>
#include <array>
#include <string>
#include <tetwarp/contact_io.hpp>

#include "io/fclib/fclib_numbers.hpp"
#include "io/files/finished_file.hpp"
#include "io/h5/h5_attribute.hpp"
#include "io/h5/h5_disk.hpp"
#include "io/h5/h5_write.hpp"

namespace tetwarp {
namespace {
constexpr const char* root_name = "tetwarp_checkpoint";
constexpr std::int64_t newest_version = 2;

/// A member of a record of one or three numbers, and its name in the file.
struct Member {
  const char* name;
  double ContactRecord::*number = nullptr;
  Point3 ContactRecord::*point = nullptr;
  std::int64_t first_version = 1;
};
constexpr std::array<Member, 9> members = {
    {{"area", &ContactRecord::area},
     {"intensity", &ContactRecord::intensity},
     {"anchor_a", nullptr, &ContactRecord::anchor_a},
     {"anchor_b", nullptr, &ContactRecord::anchor_b},
     {"normal_a", nullptr, &ContactRecord::normal_a},
     {"normal_b", nullptr, &ContactRecord::normal_b},
     {"impulse", nullptr, &ContactRecord::impulse_world},
     {"standoff", &ContactRecord::standoff, nullptr, 2},
     {"normal_world", nullptr, &ContactRecord::normal_world, 2}}};

/// A material point of a record, and its names in the file: vertices and weights.
struct Material {
  const char* vertex;
  const char* weight;
  MaterialPoint ContactRecord::*point;
};
constexpr std::array<Material, 2> materials_of_sides = {
    {{"vertex_a", "weight_a", &ContactRecord::material_a},
     {"vertex_b", "weight_b", &ContactRecord::material_b}}};

void write_records(const h5::Object& group, const std::vector<ContactRecord>& records) {
  std::vector<std::int64_t> keys, materials, touched;
  for (const ContactRecord& record : records) {
    keys.insert(keys.end(),
                {record.key.body_a, record.key.feature_a, record.key.body_b, record.key.feature_b});
    materials.push_back(record.material);
    touched.push_back(record.has_touched ? 1 : 0);
  }
  fclib::write_integers(group, "key", keys);
  fclib::write_integers(group, "material", materials);
  fclib::write_integers(group, "has_touched", touched);
  for (const Member& member : members) {
    std::vector<double> values;
    for (const ContactRecord& record : records) {
      if (member.number != nullptr) {
        values.push_back(record.*member.number);
      } else {
        const Point3& point = record.*member.point;
        values.insert(values.end(), point.begin(), point.end());
      }
    }
    fclib::write_reals(group, member.name, values);
  }
  for (const Material& side : materials_of_sides) {
    std::vector<std::int64_t> vertices;
    std::vector<double> weights;
    for (const ContactRecord& record : records) {
      const MaterialPoint& point = record.*side.point;
      vertices.insert(vertices.end(), point.vertex.begin(), point.vertex.end());
      weights.insert(weights.end(), point.weight.begin(), point.weight.end());
    }
    fclib::write_integers(group, side.vertex, vertices);
    fclib::write_reals(group, side.weight, weights);
  }
}

/// Integers that fit int32, `per_contact` for each of `count` contacts.
std::vector<std::int32_t> read_int32(const h5::Object& group,
                                     const std::string& name,
                                     std::int64_t count,
                                     std::int64_t per_contact) {
  const std::vector<std::int64_t> values = fclib::read_integers(group, name);
  const h5::Dataset dataset = h5::open_dataset(group, name);
  if (static_cast<std::int64_t>(values.size()) != per_contact * count) {
    dataset.fail("holds " + std::to_string(values.size()) + " numbers, expected " +
                 std::to_string(per_contact) + " for each of " + std::to_string(count) +
                 " contacts");
  }
  std::vector<std::int32_t> narrow;
  for (const std::int64_t value : values) {
    narrow.push_back(static_cast<std::int32_t>(value));
    if (narrow.back() != value) dataset.fail(std::to_string(value) + " does not fit 32 bits");
  }
  return narrow;
}

std::vector<ContactRecord> read_records(const h5::Object& group, std::int64_t version) {
  const std::int64_t count = fclib::element_count(h5::open_dataset(group, "intensity"));
  const std::vector<std::int32_t> keys = read_int32(group, "key", count, 4);
  const std::vector<std::int32_t> materials = read_int32(group, "material", count, 1);
  const std::vector<std::int32_t> touched = read_int32(group, "has_touched", count, 1);
  std::vector<ContactRecord> records(static_cast<std::size_t>(count));
  for (std::size_t c = 0; c < records.size(); ++c) {
    records[c].key = {keys[4 * c], keys[4 * c + 1], keys[4 * c + 2], keys[4 * c + 3]};
    records[c].material = materials[c];
    records[c].has_touched = touched[c] != 0;
  }
  for (const Member& member : members) {
    if (version < member.first_version) continue;
    const std::int64_t width = member.number != nullptr ? 1 : 3;
    const std::vector<double> values =
        fclib::read_reals(group, member.name, {width * count, "as many contacts as intensities"});
    for (std::size_t c = 0; c < records.size(); ++c) {
      if (member.number != nullptr) {
        records[c].*member.number = values[c];
      } else {
        std::copy_n(&values[3 * c], 3, (records[c].*member.point).begin());
      }
    }
  }
  if (version < 2) return records;
  for (const Material& side : materials_of_sides) {
    const std::vector<std::int32_t> vertices = read_int32(group, side.vertex, count, 3);
    const std::vector<double> weights =
        fclib::read_reals(group, side.weight, {3 * count, "as many contacts as intensities"});
    for (std::size_t c = 0; c < records.size(); ++c) {
      MaterialPoint& point = records[c].*side.point;
      std::copy_n(&vertices[3 * c], 3, point.vertex.begin());
      std::copy_n(&weights[3 * c], 3, point.weight.begin());
    }
  }
  return records;
}

void write_poses(const h5::Object& root, const std::vector<BodyPose>& poses) {
  std::vector<double> positions, rotations;
  for (const BodyPose& pose : poses) {
    positions.insert(positions.end(), pose.position.begin(), pose.position.end());
    rotations.insert(rotations.end(), pose.rotation.begin(), pose.rotation.end());
  }
  fclib::write_reals(root, "position", positions);
  fclib::write_reals(root, "rotation", rotations);
}

std::vector<BodyPose> read_poses(const h5::Object& root) {
  const std::vector<double> positions = fclib::read_reals(root, "position");
  const std::size_t count = positions.size() / 3;
  const std::vector<double> rotations = fclib::read_reals(
      root, "rotation", {static_cast<std::int64_t>(4 * count), "four per three of position"});
  std::vector<BodyPose> poses(count);
  for (std::size_t b = 0; b < count; ++b) {
    std::copy_n(&positions[3 * b], 3, poses[b].position.begin());
    std::copy_n(&rotations[4 * b], 4, poses[b].rotation.begin());
  }
  return poses;
}
}  // namespace

std::int64_t write_contact_checkpoint(const std::string& path,
                                      const ContactCheckpoint& checkpoint) {
  const h5::Silence silence;
  FinishedFile finished(path);
  h5::Disk disk;
  h5::Object file = h5::create_file(path, finished.temporary(), disk);
  {
    const h5::Object root = h5::create_group(file, root_name);
    h5::write_scalar_attribute(root, "version", newest_version);
    h5::write_scalar_attribute(root, "step", checkpoint.step);
    h5::write_scalar_attribute(root, "time", checkpoint.time);
    write_poses(root, checkpoint.poses);
    fclib::write_reals(root, "body_velocity", checkpoint.body_velocity);
    write_records(h5::create_group(root, "contacts"), checkpoint.records);
  }
  if (!file.handle.close()) file.fail_with_reason("cannot be closed");
  disk.check(file);
  return finished.finish();
}

ContactCheckpoint read_contact_checkpoint(const std::string& path) {
  const h5::Silence silence;
  const h5::Object file = h5::open_file(path);
  const h5::Object root = h5::open_group(file, root_name);
  const std::int64_t version = h5::read_integer_attribute(root, "version", 1)[0];
  if (version > newest_version) {
    root.fail("is of version " + std::to_string(version) + ", this program reads up to " +
              std::to_string(newest_version) + "; use a newer one");
  }
  ContactCheckpoint checkpoint;
  checkpoint.step = h5::read_integer_attribute(root, "step", 1)[0];
  checkpoint.time = h5::read_real_attribute(root, "time", 1)[0];
  checkpoint.poses = read_poses(root);
  checkpoint.body_velocity = fclib::read_reals(root, "body_velocity");
  checkpoint.records = read_records(h5::open_group(root, "contacts"), version);
  return checkpoint;
}

}  // namespace tetwarp
