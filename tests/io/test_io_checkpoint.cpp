/// @file test_io_checkpoint.cpp
/// A simulation restored from a checkpoint gives the same bits as one that did not stop.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <tetwarp/contact_io.hpp>

#include "tests/support/io_files.hpp"
#include "tests/support/rigid_bodies.hpp"

namespace tetwarp::test {
namespace {
WorldOptions sticky() {
  WorldOptions options;
  options.time_step = 2e-3;
  options.tracking.materials = {{.friction = 0.4,
                                 .stiffness = 1e5,
                                 .energy = 0.02,
                                 .viscosity = 0.1,
                                 .bonding_rate = 1e-2,
                                 .saturation_pressure = 2e3,
                                 .initial_intensity = 0.2}};
  return options;
}

/// Two boxes thrown onto a floor: they land, bond, shear, and partly debond.
RigidWorld thrown_boxes() {
  RigidWorld world(sticky());
  world.planes.push_back({{0, 0, 0}, {0, 0, 1}});
  for (const double x : {0.0, 0.3}) {
    RigidBox box = make_box({0.05, 0.06, 0.04}, 0.5);
    box.pose = {{x, 0, 0.05 + x / 10}, {1, 0, 0, 0}};
    box.velocity = {1, 0.5, -0.5};
    box.spin = {0.5, -1, 2 * x};
    world.boxes.push_back(box);
  }
  return world;
}

ContactCheckpoint checkpoint_of(const RigidWorld& world) {
  ContactCheckpoint checkpoint;
  checkpoint.step = 40;
  checkpoint.time = world.time();
  checkpoint.poses = world.poses();
  for (const RigidBox& box : world.boxes) {
    for (const Eigen::Vector3d& part : {box.velocity, box.spin}) {
      checkpoint.body_velocity.insert(checkpoint.body_velocity.end(), part.begin(), part.end());
    }
  }
  checkpoint.records = world.tracker.records();
  return checkpoint;
}

/// A simulation whose state comes from the checkpoint only.
RigidWorld restored(const ContactCheckpoint& checkpoint) {
  RigidWorld world = thrown_boxes();
  for (std::size_t b = 0; b < world.boxes.size(); ++b) {
    world.boxes[b].pose = checkpoint.poses[b + 1];
    world.boxes[b].velocity = Eigen::Vector3d::Map(&checkpoint.body_velocity[6 * b]);
    world.boxes[b].spin = Eigen::Vector3d::Map(&checkpoint.body_velocity[6 * b + 3]);
  }
  world.tracker = ContactTracker(sticky().tracking, checkpoint.records);
  return world;
}

void expect_same_bits(const RigidWorld& a, const RigidWorld& b) {
  ASSERT_EQ(a.tracker.records().size(), b.tracker.records().size());
  for (std::size_t c = 0; c < a.tracker.records().size(); ++c) {
    const ContactRecord& one = a.tracker.records()[c];
    const ContactRecord& other = b.tracker.records()[c];
    EXPECT_EQ(one.key, other.key);
    EXPECT_EQ(one.intensity, other.intensity);
    EXPECT_EQ(one.anchor_a, other.anchor_a);
    EXPECT_EQ(one.anchor_b, other.anchor_b);
    EXPECT_EQ(one.impulse_world, other.impulse_world);
  }
  for (std::size_t i = 0; i < a.boxes.size(); ++i) {
    EXPECT_EQ(a.boxes[i].pose.position, b.boxes[i].pose.position);
    EXPECT_EQ(a.boxes[i].pose.rotation, b.boxes[i].pose.rotation);
    EXPECT_EQ(a.boxes[i].velocity, b.boxes[i].velocity);
    EXPECT_EQ(a.boxes[i].spin, b.boxes[i].spin);
  }
}

TEST(Checkpoint, ARestoredSimulationContinuesBitForBit) {
  const ScratchFolder folder;
  RigidWorld world = thrown_boxes();
  for (int step = 0; step < 40; ++step) world.step();
  write_contact_checkpoint(folder / "c.h5", checkpoint_of(world));
  const ContactCheckpoint checkpoint = read_contact_checkpoint(folder / "c.h5");
  ASSERT_FALSE(checkpoint.records.empty());
  EXPECT_EQ(checkpoint.step, 40);
  EXPECT_EQ(checkpoint.time, world.time());

  RigidWorld again = restored(checkpoint);
  const double before = world.energy();
  for (int step = 0; step < 40; ++step) {
    world.step();
    again.step();
  }

  EXPECT_NE(world.energy(), before);
  expect_same_bits(world, again);
}

TEST(Checkpoint, KeepsEveryNumberOfARecord) {
  const ScratchFolder folder;
  ContactCheckpoint checkpoint;
  ContactRecord record{.key = {0, 1, 2, -3}, .material = 4, .has_touched = true};
  record.area = 0.1;
  record.intensity = 1.0 / 3;
  record.normal_a = {0.6, 0, 0.8};
  record.normal_b = {0, -1, 0};
  record.anchor_b = {1e-300, -0.0, 1e300};
  checkpoint.records = {record};
  write_contact_checkpoint(folder / "c.h5", checkpoint);

  const ContactRecord back = read_contact_checkpoint(folder / "c.h5").records.at(0);

  EXPECT_EQ(back.key, record.key);
  EXPECT_EQ(back.material, 4);
  EXPECT_TRUE(back.has_touched);
  EXPECT_EQ(back.area, record.area);
  EXPECT_EQ(back.intensity, record.intensity);
  EXPECT_EQ(back.normal_a, record.normal_a);
  EXPECT_EQ(back.normal_b, record.normal_b);
  EXPECT_EQ(std::memcmp(&back.anchor_b, &record.anchor_b, sizeof record.anchor_b), 0);
}

TEST(Checkpoint, OfNothingReadsAsNothing) {
  const ScratchFolder folder;
  write_contact_checkpoint(folder / "c.h5", {});

  const ContactCheckpoint back = read_contact_checkpoint(folder / "c.h5");

  EXPECT_TRUE(back.poses.empty() && back.records.empty() && back.body_velocity.empty());
  EXPECT_EQ(folder.entry_count(), 1);
}

/// Contacts of deformable bodies; and files of version 1, which know none.
TEST(Checkpoint, HoldsMaterialPointsAndReadsFilesWithoutThem) {
  const ScratchFolder folder;
  ContactCheckpoint checkpoint;
  ContactRecord record{.key = {0, 4, 1, -1}};
  record.intensity = 0.5;
  record.standoff = 1e-3;
  record.normal_world = {0, 0, -1};
  record.material_a = {{0, 0, 0}, {7, -1, -1}, {1, 0, 0}};
  record.material_b = {{0, 0, 0}, {1, 5, 2}, {0.25, 0.5, 0.25}};
  checkpoint.records = {record};
  write_contact_checkpoint(folder / "c.h5", checkpoint);

  const ContactRecord read = read_contact_checkpoint(folder / "c.h5").records.at(0);

  EXPECT_EQ(read.standoff, record.standoff);
  EXPECT_EQ(read.normal_world, record.normal_world);
  EXPECT_EQ(read.material_a.vertex, record.material_a.vertex);
  EXPECT_EQ(read.material_b.weight, record.material_b.weight);
  {
    Hdf5Editor editor(folder / "c.h5");
    const std::string root = "/tetwarp_checkpoint";
    for (const char* name :
         {"standoff", "normal_world", "vertex_a", "weight_a", "vertex_b", "weight_b"}) {
      editor.remove(root + "/contacts/" + name);
    }
    editor.attribute(root, "version", std::vector{1});
  }
  const ContactRecord old = read_contact_checkpoint(folder / "c.h5").records.at(0);
  EXPECT_EQ(old.intensity, 0.5);
  EXPECT_TRUE(old.material_a.is_rigid());
  EXPECT_EQ(old.normal_world, (Point3{0, 0, 0}));
}

TEST(Checkpoint, NamesWhatIsWrongWithAFile) {
  const ScratchFolder folder;
  ContactCheckpoint checkpoint;
  checkpoint.records = {ContactRecord{.key = {0, 0, 1, 0}}};
  const auto error_after = [&](const auto& damage) {
    write_contact_checkpoint(folder / "c.h5", checkpoint);
    {
      Hdf5Editor editor(folder / "c.h5");
      damage(editor);
    }
    return io_error([&] { read_contact_checkpoint(folder / "c.h5"); });
  };
  const std::string root = "/tetwarp_checkpoint";

  EXPECT_NE(error_after([&](Hdf5Editor& e) {
              e.attribute(root, "version", std::vector{3});
            }).find("version 3"),
            std::string::npos);
  EXPECT_NE(error_after([&](Hdf5Editor& e) { e.remove(root + "/contacts/key"); }).find("key"),
            std::string::npos);
  EXPECT_NE(error_after([&](Hdf5Editor& e) {
              e.dataset(root + "/contacts/anchor_a", {2}, std::vector<double>{1, 2});
            }).find("anchor_a"),
            std::string::npos);
  EXPECT_NE(error_after([&](Hdf5Editor& e) {
              e.dataset(root + "/contacts/key", {4}, std::vector<std::int64_t>{0, 0, 1L << 40, 0});
            }).find("32 bits"),
            std::string::npos);
  EXPECT_NE(error_after([&](Hdf5Editor& e) { e.remove(root); }).find("tetwarp_checkpoint"),
            std::string::npos);
}
}  // namespace
}  // namespace tetwarp::test
