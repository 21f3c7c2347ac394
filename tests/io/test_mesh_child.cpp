/// @file test_mesh_child.cpp
/// Readers that crash, loop without end, allocate more than the limit or return a damaged mesh.
#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <tetwarp/missing_library.hpp>
#include <tetwarp/surface_reader.hpp>
#include <vector>

#include "io/child/child_message.hpp"
#include "io/child/foreign_image.hpp"
#include "io/import/mesh_child.hpp"
#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
constexpr ChildLimits limits{20, 0x1p28};

/// Names of files tell tests/io/fake_reader.cpp how to end.
class MeshChild : public ::testing::Test {
 protected:
  MeshChild() { setenv("TETWARP_READER", TETWARP_FAKE_READER, 1); }
  ~MeshChild() override { unsetenv("TETWARP_READER"); }

  static std::string complaint(const std::string& path, const ChildLimits& of_child = limits) {
    return io_error([&] { read_mesh_in_child(path, {}, of_child); });
  }
};

TEST_F(MeshChild, SendsAllMembers) {
  const ImportedMesh mesh = read_mesh_in_child("sound", {}, limits);

  EXPECT_EQ(mesh.mesh.rest_positions, two_tets().rest_positions);
  EXPECT_EQ(mesh.mesh.tets, two_tets().tets);
  EXPECT_TRUE(mesh.mesh.hexes.empty());
  EXPECT_EQ(mesh.displacements, slides({1, 2}));
  EXPECT_EQ(mesh.times, (std::vector<double>{0.5, 2}));
  EXPECT_EQ(mesh.skipped, (std::map<std::string, std::int64_t>{{"triangle", 3}, {"line", 1}}));
}

TEST_F(MeshChild, GetsTheOptions) {
  const auto options_of = [](const MeshImportOptions& options) {
    return read_mesh_in_child("sound", options, limits).merged;
  };
  EXPECT_EQ(options_of({}), "none, solids");
  EXPECT_EQ(options_of({.displacement = "u v", .needs_solids = false}), "u v");
  EXPECT_EQ(options_of({.displacement = ""}), ", solids");
}

/// More than a pipe and the buffers of both ends hold.
TEST_F(MeshChild, SendsMeshesOfManyMegabytes) {
  const ImportedMesh mesh = read_mesh_in_child("large", {}, limits);

  EXPECT_EQ(mesh.mesh.rest_positions, std::vector<Point3>(500'000, Point3{1, 2, 3}));
}

/// A proof about the points at rest would say nothing of the motion.
TEST_F(MeshChild, GivesNoSurfaceWhoseDisplacementIsLeftOut) {
  const ScratchFolder folder;
  const auto error_of = [&](const std::string& name) {
    std::ofstream(folder / name) << "x";
    return io_error([&] { const SurfaceReader reader(folder / name); });
  };
  EXPECT_EQ(error_of("rest.vtu"), "");
  EXPECT_NE(error_of("moved.vtu").find("displacement: is not read of this format"),
            std::string::npos);
}

TEST_F(MeshChild, RefusesSamplesOfAnotherImageThanItsHeader) {
  const auto samples_of = [](const std::string& path) {
    std::string all;
    read_samples_in_child(path, "", read_image_in_child(path, ""), "density",
                          [&](const void* samples, std::size_t bytes) {
                            all.append(static_cast<const char*>(samples), bytes);
                          });
    return all;
  };
  EXPECT_EQ(samples_of("sound"), "abcdefabcdef");
  EXPECT_NE(io_error([&] { samples_of("changed"); }).find("has changed while it was read"),
            std::string::npos);
}

TEST_F(MeshChild, PassesErrorsOnInTheirWords) {
  EXPECT_EQ(complaint("io error"), "io error: u: expected three components");
  EXPECT_EQ(complaint("error"), "error: cannot be read: odd");
}

TEST_F(MeshChild, KeepsTheLibraryThatIsMissing) {
  try {
    read_mesh_in_child("missing", {}, limits);
    FAIL() << "no error";
  } catch (const MissingLibrary& error) {
    EXPECT_EQ(error.library(), "VTK");
    EXPECT_STREQ(error.what(), "missing: this build cannot read it");
  }
}

TEST_F(MeshChild, MakesOneLineOfEveryEndOfAReader) {
  const auto text = [](const std::string& path, const std::string& end) {
    return path + ": its reader " + end +
           ": the file is damaged or uses what the library cannot read; write it again";
  };
  EXPECT_EQ(complaint("segfault"), text("segfault", "crashed (Segmentation fault)"));
  EXPECT_EQ(complaint("abort"), text("abort", "crashed (Aborted)"));
  EXPECT_EQ(complaint("hang", {1, 0x1p28}), text("hang", "took more than 1 s"));
  for (const char* const path : {"end", "exit", "truncated"}) {
    EXPECT_EQ(complaint(path), text(path, "ended without a result"));
  }
}

TEST_F(MeshChild, LimitsMemory) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the address sanitizer ends a program that lacks memory";
#endif
  EXPECT_EQ(complaint("allocate"),
            "allocate: cannot be read in 256.0 MiB of memory: damaged, or too large for this "
            "machine");
}

TEST_F(MeshChild, PrintsNothing) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();

  const std::string error = complaint("print");

  EXPECT_EQ(error, "");
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST_F(MeshChild, NamesThePlaceOfAReaderThatIsMissing) {
  setenv("TETWARP_READER", "/nowhere/tetwarp-read", 1);

  EXPECT_EQ(complaint("a.vtk"),
            "a.vtk: needs the program tetwarp-read, which is not at /nowhere/tetwarp-read; install "
            "it, or set TETWARP_READER to its path");
}

TEST_F(MeshChild, TellsThatALibraryIsMissing) {
  EXPECT_EQ(message_of<std::runtime_error>([] { read_mesh_in_child("library", {}, limits); }),
            "'" TETWARP_FAKE_READER "' lacks one of its libraries; run it by itself to see which");
}

TEST_F(MeshChild, IsFoundBesideTheProgram) {
  unsetenv("TETWARP_READER");

  const std::string error = complaint("none.msh");

  EXPECT_NE(error, "");
  EXPECT_EQ(error.find("TETWARP_READER"), std::string::npos) << error;
}

/// Bytes in memory in place of those of a child.
struct Bytes {
  std::vector<std::byte> all;
  std::size_t at = 0;

  void read(void* to, std::size_t count) {
    if (count > all.size() - at) throw ChildError("ended without a result");
    std::memcpy(to, all.data() + at, count);
    at += count;
  }
};

/// A count that was damaged in the child must not become an allocation.
TEST(ChildMessage, DoesNotTrustCounts) {
  const auto read = [](std::uint64_t count) {
    Bytes bytes{std::vector<std::byte>(64)};
    std::memcpy(bytes.all.data(), &count, sizeof count);
    MessageReader message(bytes, 1e9);
    ImportedMesh mesh;
    exchange_members(message, mesh);
  };

  for (const std::uint64_t count : {3ULL, 1ULL << 25, 1ULL << 40, ~0ULL}) {
    EXPECT_THROW(read(count), ChildError) << count;
  }
}
}  // namespace
}  // namespace tetwarp::test
