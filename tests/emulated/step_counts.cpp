/// @file step_counts.cpp
/// Counts what the kernels of a step of the warp do, on workloads of the benchmarks.
///
///     tetwarp_step_counts WEIGHTS WORKLOAD...
///
/// WEIGHTS: lines "address operations", of the basic blocks of this program
/// (bench/sass/weights.py). Prints a JSON array with an object per workload: its launches in each
/// of the two poses between which the rows `resident/` of the benchmarks alternate, and that of the
/// floor. Of the raster one block in several runs, chosen by a fixed seed.
#include <cxxabi.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <tetwarp/warp.hpp>

#include "bench/measure/affine_device.cuh"
#include "bench/warp/warp_job.hpp"
#include "bench/warp/workloads.hpp"
#include "kernels/exec/launch.hpp"
#include "tests/emulator/launch_counter.hpp"

namespace tetwarp::bench {
namespace {
using simt::LaunchCounter, simt::LaunchCounts, simt::LaunchSample;

constexpr std::int64_t counted_blocks = 400;

/// Arrays in memory of the emulated device.
class DeviceBytes {
 public:
  explicit DeviceBytes(std::size_t size) { cudaMalloc(&data_, size); }
  DeviceBytes(const DeviceBytes&) = delete;
  DeviceBytes& operator=(const DeviceBytes&) = delete;
  ~DeviceBytes() { cudaFree(data_); }

  std::byte* data() const { return data_; }

 private:
  std::byte* data_ = nullptr;
};

std::string readable(const std::string& mangled) {
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> name(
      abi::__cxa_demangle(mangled.c_str(), nullptr, nullptr, &status), &std::free);
  return status == 0 ? name.get() : mangled;
}

bool has(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

/// Of the kernels of a step: which blocks are counted, about `counted_blocks` of each launch.
LaunchSample sample_of(const std::string& kernel, std::int64_t blocks, std::int64_t groups) {
  const auto one_in = [](std::int64_t all) {
    return std::max<std::int64_t>(1, all / counted_blocks);
  };
  // No other kernel depends on the samples that these kernels write.
  if (has(kernel, "PackSource")) return {blocks, false};
  if (has(kernel, "AffineDeviceJob")) return {one_in(blocks), false};
  // The other kernel of the raster has one argument, and computes the cells that groups list.
  if (has(kernel, "RasterJobIfEEi")) return {one_in(blocks), false};
  if (has(kernel, "RasterJob")) return {1, true, static_cast<double>(one_in(groups))};
  return {one_in(blocks)};
}

/// Counts steps of one workload, and its floor.
class WorkloadCounts {
 public:
  WorkloadCounts(const Workload& workload, const LaunchCounter::Weights& weights)
      : workload_(workload),
        scene_(inputs().scene(workload)),
        source_(inputs().image(workload)),
        output_(static_cast<std::size_t>(scene_.output_grid.voxel_count()) * sizeof(float)),
        counter_(
            weights,
            [] { return simt::Device::only().ranges(); },
            [this](const std::string& kernel, std::int64_t blocks) {
              if (has(kernel, "RasterJobIfEEi")) groups_ = blocks;
              return sample_of(kernel, blocks, groups_);
            }) {
    simt::LaunchObserver::current() = &counter_;
  }
  WorkloadCounts(const WorkloadCounts&) = delete;
  WorkloadCounts& operator=(const WorkloadCounts&) = delete;
  ~WorkloadCounts() { simt::LaunchObserver::current() = nullptr; }

  void print() {
    std::printf("{\"workload\": \"%s\", \"tets\": %d, \"voxels\": %lld,\n", workload_.name.c_str(),
                workload_.tet_count(), static_cast<long long>(scene_.output_grid.voxel_count()));
    Warper warper(std::span(&source_, 1), scene_.mesh,
                  {.output_grid = scene_.output_grid, .backend = Backend::cuda});
    const std::array poses{scene_.deformed, nudged_center(scene_.deformed, 1.0)};
    const auto step = [&](std::size_t pose) {
      void* const volume = output_.data();
      warper.step(poses[pose], {.volumes = {&volume, 1}, .memory = Memory::device});
      return counter_.take();
    };
    counter_.counts = false;
    step(1);
    step(0);
    counter_.counts = true;
    print("nudged", step(1));
    std::printf(",\n");
    print("pose", step(0));
    std::printf(",\n");
    print("floor", floor());
    std::printf("}");
  }

 private:
  static void print(const char* name, const std::vector<LaunchCounts>& launches) {
    std::printf(" \"%s\": [", name);
    for (const LaunchCounts& launch : launches) {
      std::printf(
          "%s\n  {\"kernel\": \"%s\", \"blocks\": %lld, \"threads\": %lld, \"operations\": %.6g, "
          "\"lane_operations\": %.6g, \"longest_warp\": %.6g, \"barriers\": %.6g, "
          "\"requests\": %.6g, \"sectors\": %.6g, \"least_sectors\": %.6g, "
          "\"block_bytes\": %.6g, \"bytes\": %.6g}",
          &launch == launches.data() ? "" : ",", readable(launch.kernel).c_str(),
          static_cast<long long>(launch.blocks), static_cast<long long>(launch.threads),
          launch.operations, launch.lane_operations, launch.longest_warp, launch.barriers,
          launch.requests, launch.sectors, launch.least_sectors, launch.block_bytes, launch.bytes);
    }
    std::printf("]");
  }

  /// The output through one map, as measured beside the steps: the better of two tile shapes.
  std::vector<LaunchCounts> floor() {
    const std::size_t size =
        static_cast<std::size_t>(scene_.source_grid.voxel_count()) * sizeof(float);
    const DeviceBytes samples(size);
    AffineDeviceJob<float, LinearSource<float>> job = {};
    job.source.data = reinterpret_cast<const float*>(samples.data());
    job.output = reinterpret_cast<float*>(output_.data());
    const AffineRows rows = floor_map(workload_);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      job.source.dims[axis] = static_cast<int>(scene_.source_grid.dims[axis]);
      job.source_dims[axis] = job.source.dims[axis];
      job.output_dims[axis] = static_cast<int>(scene_.output_grid.dims[axis]);
      std::copy_n(rows[axis].begin(), 4, job.rows[axis]);
    }
    const auto run = [&]<class Tile>(Tile) {
      launch(nullptr, affine_kernel<Tile, true, float, LinearSource<float>>, tiles_of<Tile>(job),
             dim3(floor_threads), 0, job);
    };
    run(Tile<8, 8>{});
    run(Tile<32, 4>{});
    return counter_.take();
  }

  Workload workload_;
  const scenes::Scene& scene_;
  VolumeView source_;
  DeviceBytes output_;
  std::int64_t groups_ = 1;  ///< blocks of the last raster of groups
  LaunchCounter counter_;
};

Workload workload_of(const std::string& name) {
  for (const Workload& one :
       {torso_700(), orange_160(), fish_35(), waved(256, 5000), waved(256, 50000),
        waved(256, 500000), rotated(128), rotated(256), rotated(384), rotated(384, 40),
        rotated(384, 135), rotated(384, 320), rotated(384, 2560)}) {
    if (one.name == name) return one;
  }
  throw std::invalid_argument("no workload " + name + "; see bench/warp/workloads.cpp");
}

LaunchCounter::Weights read_weights(const std::string& name) {
  std::ifstream file(name);
  LaunchCounter::Weights weights;
  std::uintptr_t address = 0;
  double operations = 0;
  while (file >> address >> operations) weights[address] = operations;
  if (weights.empty()) throw std::invalid_argument("no weights in " + name);
  return weights;
}
}  // namespace
}  // namespace tetwarp::bench

int main(int count, char** arguments) try {
  const std::span<char*> given(arguments, static_cast<std::size_t>(count));
  if (given.size() < 3) throw std::invalid_argument("arguments: WEIGHTS WORKLOAD...");
  const auto weights = tetwarp::bench::read_weights(given[1]);
  for (const char* const name : given.subspan(2)) {
    std::printf(name == given[2] ? "[" : ",\n");
    tetwarp::bench::WorkloadCounts(tetwarp::bench::workload_of(name), weights).print();
  }
  std::printf("]\n");
} catch (const std::exception& error) {
  std::fprintf(stderr, "tetwarp_step_counts: %s\n", error.what());
  return 1;
}
