/// @file test_mesh_child.cpp
/// Readers that crash, loop without end, allocate more than the limit or return a damaged mesh.
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "io/import/child_message.hpp"
#include "io/import/mesh_child.hpp"
#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
constexpr ChildLimits limits{20, 0x1p28};

ImportedMesh two_steps() {
  return {two_tets(), slides({1, 2}), {0.5, 2}, {{"triangle", 3}, {"line", 1}}};
}

std::string complaint(const std::function<void()>& before_the_end,
                      const ChildLimits& of_child = limits) {
  return io_error([&] {
    read_mesh_in_child("a.vtk", of_child, [&] {
      before_the_end();
      return two_steps();
    });
  });
}

TEST(MeshChild, SendsAllMembers) {
  const ImportedMesh mesh = read_mesh_in_child("a.vtk", limits, two_steps);

  EXPECT_EQ(mesh.mesh.rest_positions, two_tets().rest_positions);
  EXPECT_EQ(mesh.mesh.tets, two_tets().tets);
  EXPECT_TRUE(mesh.mesh.hexes.empty());
  EXPECT_EQ(mesh.displacements, slides({1, 2}));
  EXPECT_EQ(mesh.times, (std::vector<double>{0.5, 2}));
  EXPECT_EQ(mesh.skipped, (std::map<std::string, std::int64_t>{{"triangle", 3}, {"line", 1}}));
}

/// More than a pipe and the buffers of both ends hold.
TEST(MeshChild, SendsMeshesOfManyMegabytes) {
  const std::vector<Point3> points(500'000, Point3{1, 2, 3});

  const ImportedMesh mesh = read_mesh_in_child("a.vtk", limits, [&] {
    ImportedMesh large;
    large.mesh.rest_positions = points;
    return large;
  });

  EXPECT_EQ(mesh.mesh.rest_positions, points);
}

TEST(MeshChild, PassesErrorsOnInTheirWords) {
  const auto fails = [] { throw IoError("a.vtk", "u", "expected three components"); };

  EXPECT_EQ(complaint(fails), "a.vtk: u: expected three components");
  EXPECT_EQ(complaint([] { throw std::runtime_error("odd"); }), "a.vtk: cannot be read: odd");
}

TEST(MeshChild, MakesOneLineOfEveryEndOfAReader) {
  const auto text = [](const std::string& end) {
    return "a.vtk: its reader " + end +
           ": the file is damaged or uses what the library cannot read; write it again";
  };
  EXPECT_EQ(complaint([] { std::signal(SIGSEGV, SIG_DFL), raise(SIGSEGV); }),
            text("crashed (Segmentation fault)"));
  EXPECT_EQ(complaint([] { std::abort(); }), text("crashed (Aborted)"));
  EXPECT_EQ(complaint([] { _exit(0); }), text("ended without a result"));
  EXPECT_EQ(complaint([] { std::exit(3); }), text("ended without a result"));
  EXPECT_EQ(complaint([] { pause(); }, {1, 0x1p28}), text("took more than 1 s"));
}

TEST(MeshChild, LimitsMemory) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the address sanitizer ends a program that lacks memory";
#endif
  const auto allocate = [] {
    std::vector<std::vector<char>> blocks;
    blocks.reserve(64);
    for (int block = 0; block < 64; ++block) blocks.emplace_back(std::size_t{1} << 24, 'x');
  };

  EXPECT_EQ(complaint(allocate),
            "a.vtk: cannot be read in 256.0 MiB of memory: damaged, or too large for this machine");
}

TEST(MeshChild, PrintsNothing) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();

  const std::string error = complaint([] {
    std::printf("corrupted size\n");
    std::fprintf(stderr, "corrupted size\n");
    std::fflush(stdout);
  });

  EXPECT_EQ(error, "");
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
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
TEST(MeshChild, DoesNotTrustCounts) {
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
