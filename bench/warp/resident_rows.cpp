#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <type_traits>
#include <vector>

#include "bench/measure/device_floors.hpp"
#include "bench/measure/device_memory.hpp"
#include "bench/warp/figure_cases.hpp"
#include "bench/warp/rows.hpp"
#include "bench/warp/warp_job.hpp"
#include "host/base/pixel_dispatch.hpp"

namespace tetwarp::bench {
namespace {
/// A Warper whose source, positions and output are in memory of the device. Steps alternate between
/// the workload's pose and another one.
class ResidentJob {
 public:
  ResidentJob(const scenes::Scene& scene,
              const VolumeView& source,
              const SkipOptions& skip,
              bool stage_times = false)
      : bytes_(static_cast<std::size_t>(scene.output_grid.voxel_count()) * size_of(source.type)),
        node_count_(static_cast<std::int64_t>(scene.deformed.size())),
        positions_{DeviceMemory(scene.deformed.size() * sizeof(Point3)),
                   DeviceMemory(scene.deformed.size() * sizeof(Point3))},
        output_(bytes_),
        warper_(std::span(&source, 1),
                scene.mesh,
                {.output_grid = scene.output_grid,
                 .backend = Backend::cuda,
                 .stage_times = stage_times,
                 .expert = {.skip = skip}}) {
    positions_[0].put(scene.deformed.data());
    positions_[1].put(nudged_center(scene.deformed, 1.0).data());
  }

  StepReport step(std::size_t pose) {
    void* const volume = output_.data();
    const auto* const xyz = static_cast<const double*>(positions_[pose].data());
    return warper_.step({xyz, node_count_, Memory::device},
                        {.volumes = {&volume, 1}, .memory = Memory::device});
  }
  std::vector<std::byte> output() const {
    std::vector<std::byte> copy(bytes_);
    output_.get(copy.data());
    return copy;
  }
  double bytes() const { return 2.0 * static_cast<double>(bytes_); }

 private:
  std::size_t bytes_;
  std::int64_t node_count_;
  std::array<DeviceMemory, 2> positions_;
  DeviceMemory output_;
  Warper warper_;
};

/// Whether samples are those of the cpu, but for fused multiply-add: it moves a position by less
/// than 170 u (u = 2^-24), and neighbors along each axis differ by at most the range of the
/// samples; 4 u for the blends. An integer may be rounded the other way.
template <class T>
bool agree(const std::vector<std::byte>& output, const WarpJob& cpu) {
  std::vector<T> found(output.size() / sizeof(T)), wanted(found.size());
  if (output.size() != cpu.output_bytes()) return false;
  std::memcpy(found.data(), output.data(), output.size());
  std::memcpy(wanted.data(), cpu.output(), output.size());
  const auto [least, most] = std::ranges::minmax(wanted);
  const double range = static_cast<double>(most) - static_cast<double>(least);
  const double bound = std::is_integral_v<T> ? 1 : 0x1p-24 * (3 * 170 + 4) * range;
  return std::ranges::equal(found, wanted, [bound](T f, T w) {
    return std::abs(static_cast<double>(f) - static_cast<double>(w)) <= bound;
  });
}

void run(benchmark::State& state,
         const Workload& workload,
         PixelType type,
         const SkipOptions& skip) {
  const scenes::Scene& scene = inputs().scene(workload);
  const VolumeView source = inputs().image(workload, type);
  WarpJob plain(scene, source, {.backend = Backend::cpu});
  plain.step();
  StepReport report;
  {
    ResidentJob measured(scene, source, skip, true);
    measured.step(1);
    report = measured.step(0);
  }
  ResidentJob job(scene, source, skip);
  job.step(1);
  job.step(0);
  bool is_same = false;
  with_pixel_type(source.type, [&]<class T>(T) { is_same = agree<T>(job.output(), plain); });
  if (!is_same) {
    return refuse(state, "a step in device memory differs from that of the cpu");
  }
  std::size_t pose = 0;
  const std::function<void()> step = [&] { job.step(pose = 1 - pose); };
  const Timing timing =
      time_in_turn(std::span(&step, 1), {.repetitions = 51, .attempts = 51, .seconds = 5}).front();
  count_timing(state, timing);
  static const double bandwidth = device_copy_bandwidth(0);
  Buffer room(plain.output_bytes());
  const AffineJob floor_job = {source.type, Filter::linear, source.grid.dims,   plain.grid().dims,
                               source.data, room.data(),    floor_map(workload)};
  const DeviceFloor floor = measure_device_floor(floor_job, 0);
  state.SetLabel(floor.layout);
  state.counters["floor"] = 1e3 * floor.kernel;
  state.counters["floor_ratio"] = timing.median / floor.kernel;
  state.counters["copy_ratio"] = timing.median * bandwidth / job.bytes();
  state.counters["voxels"] = static_cast<double>(plain.grid().voxel_count());
  state.counters["tets"] = workload.tet_count();
  state.counters["kernel"] = 1e3 * (report.timings.setup + report.timings.mask +
                                    report.timings.cull + report.timings.raster);
}
}  // namespace

void add_resident_rows(const Selection& selection) {
  if (!selection.with_cuda) return;
  const SkipVariant no_culling = skip_variants().front();
  const auto add = [](const Workload& workload, const SkipVariant& without,
                      PixelType type = PixelType::float32) {
    add_row("resident/" + workload.name + "/linear/" + name_of(type) + "/cuda" +
                (without.name.empty() ? "" : "/without:" + without.name),
            [=](benchmark::State& state) { run(state, workload, type, without.skip); });
  };
  for (const Workload& workload : {torso_700(), orange_160(), fish_35(), waved(256, 5000),
                                   waved(256, 50000), waved(256, 500000)}) {
    add(workload, {});
  }
  if (!selection.is_full()) {
    for (const std::int64_t n : {256, 384}) add(rotated(n), {});
  } else {
    for (const Workload& workload : figure_workloads()) {
      add(workload, {});
      add(workload, no_culling);
    }
  }
  for (const PixelType type : {PixelType::int16, PixelType::uint8}) add(rotated(384), {}, type);
}

}  // namespace tetwarp::bench
