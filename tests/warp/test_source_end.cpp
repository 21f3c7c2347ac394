/// @file test_source_end.cpp
/// No byte behind the last sample of the source is read.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <span>
#include <vector>

#include <tetwarp/make.hpp>
#include <tetwarp/warp.hpp>

#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
/// A copy of some bytes that ends where memory ends: reading on kills the process.
class FencedBytes {
 public:
  explicit FencedBytes(std::span<const std::byte> bytes) {
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    const std::size_t room = (bytes.size() + page - 1) / page * page;
    size_ = room + page;
    base_ = mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (base_ == MAP_FAILED) throw std::bad_alloc();
    auto* fence = static_cast<std::byte*>(base_) + room;
    mprotect(fence, page, PROT_NONE);
    data_ = fence - bytes.size();
    std::memcpy(data_, bytes.data(), bytes.size());
  }
  ~FencedBytes() { munmap(base_, size_); }
  FencedBytes(const FencedBytes&) = delete;
  FencedBytes& operator=(const FencedBytes&) = delete;

  const void* data() const { return data_; }

 private:
  void* base_;
  std::byte* data_;
  std::size_t size_;
};

/// Shifts by less than a voxel, so that some positions lie before, on and behind the last samples.
TEST(SourceEnd, IsNotReadBeyond) {
  for (const std::array<std::int64_t, 3>& dims :
       {std::array<std::int64_t, 3>{8, 9, 8}, {9, 8, 9}, {17, 16, 10}, {3, 10, 9}, {2, 2, 10}}) {
    for (const PixelType type : {PixelType::uint8, PixelType::int16, PixelType::float32}) {
      for (const int components : {1, 2, 3, 5}) {
        Grid grid;
        grid.dims = dims;
        const Volume volume = scenes::wavy_volume(grid, type, components);
        const FencedBytes fenced(volume.data);
        const Mesh mesh = make_lattice_mesh(volume);
        const VolumeView view(grid, type, components, fenced.data(), Memory::host);
        WarpOptions options;
        options.backend = Backend::cpu;
        options.threads = 1;
        Warper near(std::span(&view, 1), mesh, options), far(volume, mesh, options);
        for (int shift = 0; shift < 27; ++shift) {
          const int row = shift / 3, slice = row / 3;
          std::vector<Point3> deformed = mesh.rest_positions;
          for (Point3& p : deformed) {
            p[0] -= 0.2 * (shift % 3);
            p[1] -= 0.2 * (row % 3);
            p[2] -= 0.2 * slice;
          }

          EXPECT_EQ(near.step(deformed).data, far.step(deformed).data);
        }
      }
    }
  }
}
}  // namespace
}  // namespace tetwarp::test
