/// @file features.cpp
#include "bench/features.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/inputs.hpp"
#include "bench/measure.hpp"
#include "bench/timing.hpp"

namespace tetwarp::bench {

namespace {

/// A feature, and what is plain beside it.
struct Feature {
  std::string name;
  WarpOptions options = {};
  int components = 1;
  double shrink = 1;         ///< of the deformed mesh
  bool hexahedra = false;    ///< instead of tetrahedra
  std::int64_t divisor = 1;  ///< of the voxels per axis: what takes long is timed on fewer
};

std::vector<Feature> features() {
  return {{.name = "antialias", .options = {.antialias = true}, .shrink = 0.5},
          {.name = "vectors", .options = {.quantities = {Quantity::vector}}, .components = 3},
          {.name = "tensors", .options = {.quantities = {Quantity::tensor}}, .components = 6},
          {.name = "density", .options = {.intensity = Intensity::density}},
          {.name = "conservative", .options = {.intensity = Intensity::conservative}, .divisor = 4},
          {.name = "hexahedra", .hexahedra = true}};
}

/// The torso on `share` of its voxels per axis, shrunk.
scenes::Scene scene_of(const Feature& feature, std::int64_t divisor) {
  Workload workload = torso_700();
  for (std::int64_t& dims : workload.dims) dims /= divisor;
  scenes::Scene scene = make_scene(workload);
  for (Point3& p : scene.deformed) {
    for (double& x : p) x *= feature.shrink;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    scene.output_grid.origin[axis] = std::floor(scene.output_grid.origin[axis] * feature.shrink);
    const double dims = static_cast<double>(scene.output_grid.dims[axis]) * feature.shrink;
    scene.output_grid.dims[axis] = static_cast<std::int64_t>(std::ceil(dims)) + 1;
  }
  return scene;
}

/// The lattice's cubes in place of their tetrahedra.
void take_cubes(Mesh& mesh, const std::array<int, 3>& cells) {
  mesh.tets.clear();
  const auto node = [&](int a, int b, int c) {
    return (c * (cells[1] + 1) + b) * (cells[0] + 1) + a;
  };
  for (int c = 0; c < cells[2]; ++c) {
    for (int b = 0; b < cells[1]; ++b) {
      for (int a = 0; a < cells[0]; ++a) {
        mesh.hexes.push_back({node(a, b, c), node(a + 1, b, c), node(a + 1, b + 1, c),
                              node(a, b + 1, c), node(a, b, c + 1), node(a + 1, b, c + 1),
                              node(a + 1, b + 1, c + 1), node(a, b + 1, c + 1)});
      }
    }
  }
}

/// A warper and its outputs.
class Job {
 public:
  Job(const Feature& feature,
      const scenes::Scene& scene,
      const VolumeView& source,
      Backend backend,
      int threads)
      : deformed_(scene.deformed) {
    Mesh mesh = scene.mesh;
    if (feature.hexahedra) take_cubes(mesh, torso_700().cells);
    WarpOptions options = feature.options;
    options.output_grid = scene.output_grid;
    options.backend = backend;
    options.threads = threads;
    options.skip.unchanged_tets = false;
    warper_.emplace(std::span(&source, 1), mesh, options);
    const auto voxels = static_cast<std::size_t>(scene.output_grid.voxel_count());
    values_.resize(voxels * static_cast<std::size_t>(source.components));
  }

  void step() {
    void* const out = values_.data();
    covered_ = warper_->step(deformed_, {.volumes = std::span(&out, 1)}).counts.covered;
  }

  std::int64_t covered() const { return covered_; }

  double distance_to(const Job& other) const {
    double largest = 0;
    for (std::size_t s = 0; s < values_.size(); ++s) {
      largest = std::max(largest, error_between(values_[s], other.values_[s]));
    }
    return largest;
  }

 private:
  const std::vector<Point3>& deformed_;
  std::optional<Warper> warper_;
  std::vector<float> values_;
  std::int64_t covered_ = 0;
};

/// Largest difference from the reference on a small volume.
double error_of(const Feature& feature, int threads) {
  const scenes::Scene scene = scene_of(feature, 4 * feature.divisor);
  const Buffer image =
      make_image(scene.source_grid, PixelType::float32, Image::textured, feature.components);
  const VolumeView source{scene.source_grid, PixelType::float32, feature.components, image.data(),
                          Memory::host};
  Job here(feature, scene, source, Backend::cpu, threads);
  Job judge(feature, scene, source, Backend::reference, 1);
  here.step();
  judge.step();
  return here.distance_to(judge);
}

void run(benchmark::State& state, const Feature& feature, int threads) {
  const double error = error_of(feature, threads);
  if (!(error <= 2e-5)) return refuse(state, "differs from the reference");
  const scenes::Scene scene = scene_of(feature, feature.divisor);
  const Buffer image =
      make_image(scene.source_grid, PixelType::float32, Image::textured, feature.components);
  const VolumeView source{scene.source_grid, PixelType::float32, feature.components, image.data(),
                          Memory::host};
  Feature none = feature;
  none.options = {};
  none.hexahedra = false;
  Job with(feature, scene, source, Backend::cpu, threads);
  Job plain(none, scene, source, Backend::cpu, threads);
  const std::function<void()> jobs[] = {[&] { with.step(); }, [&] { plain.step(); }};
  for (const auto& job : jobs) job();  // first touch
  const auto timings = time_in_turn(jobs, {.busy_threads = static_cast<double>(threads)});
  count_timing(state, timings[0]);
  state.counters["plain"] = 1e3 * timings[1].median;
  state.counters["cost"] = timings[0].median / timings[1].median;
  state.counters["ns_per_covered"] = 1e9 * timings[0].median / static_cast<double>(with.covered());
  state.counters["max_error"] = error;
}

}  // namespace

void register_feature_rows(int threads) {
  for (const Feature& feature : features()) {
    const std::string name =
        "feature/" + feature.name + "/linear/float32/cpu/threads:" + std::to_string(threads);
    benchmark::RegisterBenchmark(name.c_str(),
                                 [=](benchmark::State& state) { run(state, feature, threads); })
        ->UseManualTime()
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
  }
}

}  // namespace tetwarp::bench
