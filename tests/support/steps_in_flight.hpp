/// @file steps_in_flight.hpp
/// A series of steps twice: two in flight at a time, and one by one from scratch.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include <tetwarp/page_lock.hpp>
#include <tetwarp/warp.hpp>

#include "tests/support/scenes.hpp"

namespace tetwarp::test {

enum class Pages { pageable, locked };

/// All outputs of a step, one after the other.
using Bits = std::vector<std::byte>;

/// Memory for all outputs of a step, filled with 0xee.
class StepBuffers {
 public:
  StepBuffers(const std::vector<Volume>& sources, const Grid& grid, Pages pages) {
    const auto voxels = static_cast<std::size_t>(grid.voxel_count());
    for (const Volume& source : sources) {
      add(voxels * static_cast<std::size_t>(source.components) * size_of(source.type));
    }
    volume_count_ = parts_.size();
    add(voxels);
    add(voxels * sizeof(std::int32_t));
    add(3 * voxels * sizeof(float));
    add(6 * voxels * sizeof(float));
    for (Bits& part : parts_) {
      pointers_.push_back(part.data());
      if (pages == Pages::locked) locks_.emplace_back(part.data(), part.size());
    }
  }

  WarpTarget target(bool holds_previous) const {
    return {.volumes = {pointers_.data(), volume_count_},
            .mask = static_cast<std::uint8_t*>(pointers_[volume_count_]),
            .owner = static_cast<std::int32_t*>(pointers_[volume_count_ + 1]),
            .fields = {.displacement = static_cast<float*>(pointers_[volume_count_ + 2]),
                       .strain = static_cast<float*>(pointers_[volume_count_ + 3])},
            .holds_previous = holds_previous};
  }

  bool are_locked() const {
    return std::all_of(locks_.begin(), locks_.end(),
                       [](const PageLock& lock) { return lock.is_locked(); });
  }

  Bits bits() const {
    Bits all;
    for (const Bits& part : parts_) all.insert(all.end(), part.begin(), part.end());
    return all;
  }

 private:
  void add(std::size_t size) { parts_.emplace_back(size, std::byte{0xee}); }

  std::vector<Bits> parts_;
  std::size_t volume_count_ = 0;
  std::vector<void*> pointers_;
  std::vector<PageLock> locks_;
};

using Steps = std::vector<std::vector<Point3>>;

inline Warper make_warper(const std::vector<Volume>& sources,
                          const scenes::Scene& scene,
                          WarpOptions options) {
  options.output_grid = scene.output_grid;
  const std::vector<VolumeView> views(sources.begin(), sources.end());
  return Warper(views, scene.mesh, options);
}

/// Every step into the other one of two buffers, begun before the last is finished.
inline std::vector<Bits> steps_in_flight(const std::vector<Volume>& sources,
                                         const scenes::Scene& scene,
                                         const WarpOptions& options,
                                         const Steps& steps,
                                         Pages pages,
                                         bool holds_previous) {
  const StepBuffers buffers[] = {{sources, scene.output_grid, pages},
                                 {sources, scene.output_grid, pages}};
  if (pages == Pages::locked && options.backend == Backend::cuda) {
    EXPECT_TRUE(buffers[0].are_locked() && buffers[1].are_locked());
  }
  Warper warper = make_warper(sources, scene, options);
  std::vector<Bits> results;
  const auto finish = [&] {
    warper.finish_step();
    results.push_back(buffers[results.size() % 2].bits());
  };
  for (std::size_t s = 0; s < steps.size(); ++s) {
    std::vector<Point3> positions = steps[s];
    warper.begin_step(positions, buffers[s % 2].target(holds_previous));
    positions.assign(positions.size(), {});  // positions may be changed after begin_step()
    if (s > 0) finish();
  }
  finish();
  return results;
}

inline std::vector<Bits> steps_one_by_one(const std::vector<Volume>& sources,
                                          const scenes::Scene& scene,
                                          WarpOptions options,
                                          const Steps& steps) {
  options.expert.skip.unchanged_tets = false;
  const StepBuffers buffer(sources, scene.output_grid, Pages::pageable);
  Warper warper = make_warper(sources, scene, options);
  std::vector<Bits> results;
  for (const std::vector<Point3>& positions : steps) {
    warper.step(positions, buffer.target(false));
    results.push_back(buffer.bits());
  }
  return results;
}

}  // namespace tetwarp::test
