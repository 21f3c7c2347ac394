/// @file test_io_arrays.cpp
/// The arrays of a volume file: their order, and the one that is read when none is named.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
TEST(VtkhdfArrays, KeepsTheOrderOfArraysAndReadsTheActiveOne) {
  const ScratchFolder folder;
  const std::string path = folder / "v.vtkhdf";
  const auto write = [&](const std::vector<std::string>& names, const std::string& scalars) {
    std::vector<Volume> volumes;
    volumes.reserve(names.size());
    for (const std::string& name : names) {
      volumes.push_back(counting_volume(PixelType::uint8, 1, name));
    }
    std::vector<const Volume*> pointers;
    pointers.reserve(names.size());
    for (const Volume& volume : volumes) pointers.push_back(&volume);
    write_volumes(path, pointers, {.scalars = scalars});
    const VolumeHeader header = read_volume_header(path);
    for (std::size_t a = 0; a < names.size(); ++a) EXPECT_EQ(header.arrays[a].name, names[a]);
    EXPECT_EQ(VolumeReader(path).array_names(), names);
    EXPECT_EQ(read_volume(path).name, header.active);
    return header.active;
  };

  EXPECT_EQ(write({"z", "tetwarp_mask", "b"}, "b"), "b");
  EXPECT_EQ(write({"tetwarp_mask", "z", "b"}, "missing"), "z");
  EXPECT_EQ(write({"tetwarp_tet", "tetwarp_mask"}, ""), "tetwarp_tet");
}

/// Without tracked creation order, as in most files of other programs, arrays are ordered by name.
TEST(VtkhdfArrays, ReadsTheActiveArrayOfForeignFiles) {
  const ScratchFolder folder;
  const std::string path = folder / "v.vtkhdf";
  const std::vector<std::int32_t> values(12, 7);
  Hdf5Editor(path, Hdf5Editor::Mode::create)
      .group("VTKHDF")
      .group("VTKHDF/PointData")
      .text("VTKHDF", "Type", "ImageData")
      .attribute<std::int64_t>("VTKHDF", "WholeExtent", {0, 2, 0, 1, 0, 1})
      .attribute<double>("VTKHDF", "Origin", {1, 2, 3})
      .attribute<double>("VTKHDF", "Spacing", {0.5, 2, 1})
      .dataset("VTKHDF/PointData/a", {2, 2, 3}, values);
  Hdf5Editor(path).dataset("VTKHDF/PointData/tetwarp_b", {2, 2, 3}, values);
  Hdf5Editor(path).dataset("VTKHDF/PointData/A", {2, 2, 3}, values);

  EXPECT_EQ(VolumeReader(path).array_names(), (std::vector<std::string>{"A", "a", "tetwarp_b"}));
  EXPECT_EQ(read_volume(path).name, "A");
  Hdf5Editor(path).text("VTKHDF/PointData", "Scalars", "tetwarp_b");
  EXPECT_EQ(read_volume(path).name, "tetwarp_b");
  Hdf5Editor(path).attribute<double>("VTKHDF/PointData", "Scalars", {1, 2});
  EXPECT_EQ(read_volume(path).name, "A");
}

TEST(VtkhdfArrays, ReadsWhatOtherFilesHoldBehindLinks) {
  const ScratchFolder folder;
  const Volume volume = counting_volume(PixelType::float32, 1, "v");
  write_volumes(folder / "data.vtkhdf", {&volume}, {});
  const std::string path = folder / "linked.vtkhdf", array = "/VTKHDF/PointData/v";
  write_volumes(path, {&volume}, {});
  Hdf5Editor(path).remove(array).external_link(array, "data.vtkhdf", array);

  EXPECT_EQ(read_volume(path).data, volume.data);
}
}  // namespace
}  // namespace tetwarp::test
