#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/warp/rows.hpp"
#include "bench/warp/warp_job.hpp"

namespace tetwarp::bench {
namespace {
/// A feature: options, mesh and source that differ from the plain step.
struct Feature {
  std::string name;
  WarpOptions options = {};
  int components = 1;
  double shrink = 1;         ///< factor on the deformed positions
  bool hexahedra = false;    ///< instead of tetrahedra
  std::int64_t divisor = 1;  ///< of the voxels per axis: slow features are timed on fewer voxels
};

std::vector<Feature> features() {
  return {{.name = "antialias", .options = {.antialias = true}, .shrink = 0.5},
          {.name = "vectors", .options = {.quantities = {Quantity::vector}}, .components = 3},
          {.name = "tensors", .options = {.quantities = {Quantity::tensor}}, .components = 6},
          {.name = "density", .options = {.intensity = Intensity::density}},
          {.name = "conservative", .options = {.intensity = Intensity::conservative}, .divisor = 4},
          {.name = "hexahedra", .hexahedra = true}};
}

/// The torso with 1 / divisor of its voxels per axis, its deformed mesh shrunk.
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

/// Replaces the tetrahedra of a lattice by its cubes.
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

/// A job with or without the feature.
class FeatureJob {
 public:
  FeatureJob(const Feature& feature,
             const scenes::Scene& scene,
             const VolumeView& source,
             Backend backend,
             int threads)
      : mesh_(scene.mesh) {
    if (feature.hexahedra) take_cubes(mesh_, torso_700().cells);
    WarpOptions options = feature.options;
    options.backend = backend;
    options.threads = threads;
    job_.emplace(scene, source, options, &mesh_);
  }

  void step() { job_->step(); }
  std::int64_t covered() const { return job_->covered(); }

  double distance_to(const FeatureJob& other) const {
    double largest = 0;
    for (std::size_t s = 0; s < values().size(); ++s) {
      largest = std::max(largest, error_between(values()[s], other.values()[s]));
    }
    return largest;
  }

 private:
  std::span<const float> values() const {
    return {reinterpret_cast<const float*>(job_->output()), job_->output_bytes() / sizeof(float)};
  }

  Mesh mesh_;
  std::optional<WarpJob> job_;
};

/// Largest difference from the reference on a small volume.
double error_of(const Feature& feature, int threads) {
  const scenes::Scene scene = scene_of(feature, 4 * feature.divisor);
  const Buffer image =
      make_image(scene.source_grid, PixelType::float32, Image::textured, feature.components);
  const VolumeView source{scene.source_grid, PixelType::float32, feature.components, image.data(),
                          Memory::host};
  FeatureJob subject(feature, scene, source, Backend::cpu, threads);
  FeatureJob reference(feature, scene, source, Backend::reference, 1);
  subject.step();
  reference.step();
  return subject.distance_to(reference);
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
  FeatureJob with(feature, scene, source, Backend::cpu, threads);
  FeatureJob plain(none, scene, source, Backend::cpu, threads);
  const std::function<void()> jobs[] = {[&] { with.step(); }, [&] { plain.step(); }};
  for (const auto& job : jobs) job();  // first touch
  const std::vector<Timing> timings = time_in_turn(jobs, protocol_for(Backend::cpu, threads));
  count_beside(state, timings, "plain", "cost");
  state.counters["ns_per_covered"] = 1e9 * timings[0].median / static_cast<double>(with.covered());
  state.counters["max_error"] = error;
}
}  // namespace

void add_feature_rows(const Selection& selection) {
  const int threads = selection.threads;
  for (const Feature& feature : features()) {
    add_row("feature/" + feature.name + "/linear/float32/" + place_of(Backend::cpu, threads),
            [=](benchmark::State& state) { run(state, feature, threads); });
  }
}

}  // namespace tetwarp::bench
