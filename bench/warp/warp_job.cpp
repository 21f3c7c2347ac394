#include "bench/warp/warp_job.hpp"

#include <numbers>
#include <span>
#include <utility>

#include <tetwarp/names.hpp>

namespace tetwarp::bench {
namespace {
WarpOptions repeated(WarpOptions options, const scenes::Scene& scene) {
  options.output_grid = scene.output_grid;
  options.expert.skip.unchanged_tets = false;
  return options;
}
}  // namespace

const scenes::Scene& Inputs::scene(const Workload& workload) {
  if (scene_name_ != workload.name) {
    scene_name_ = workload.name;
    scene_ = make_scene(workload);
    truth_.reset();
    image_name_.clear();
  }
  return scene_;
}

const Truth& Inputs::truth(const Workload& workload) {
  const scenes::Scene& made = scene(workload);
  if (!truth_) truth_ = make_truth(made);
  return *truth_;
}

VolumeView Inputs::image(const Workload& workload, PixelType type, Image image, int components) {
  const Grid& grid = scene(workload).source_grid;
  const std::string name = std::string(name_of(type)) + "/" + std::to_string(components) + "/" +
                           std::to_string(static_cast<int>(image));
  if (image_name_ != name) {
    image_ = Buffer();  // two large images need not fit into memory together
    image_ = make_image(grid, type, image, components);
    image_name_ = name;
  }
  return {grid, type, components, image_.data(), Memory::host};
}

Inputs& inputs() {
  static Inputs held;
  return held;
}

AffineRows floor_map(const Workload& workload) {
  const bool is_rotation = workload.deformation == bench::Deformation::rotation;
  const scenes::Scene& scene = inputs().scene(workload);
  return turned_about_middle(scene.source_grid, scene.output_grid,
                             std::numbers::pi / (is_rotation ? 4 : 36));
}

WarpJob::WarpJob(const scenes::Scene& scene,
                 const VolumeView& source,
                 WarpOptions options,
                 const Mesh* mesh)
    : scene_(scene),
      source_(source),
      warper_(std::span(&source, 1),
              mesh != nullptr ? *mesh : scene.mesh,
              repeated(std::move(options), scene)),
      output_(output_bytes()) {}

const StepReport& WarpJob::step(WarpTarget target) {
  void* const out = output_.data();
  target.volumes = std::span(&out, 1);
  return last_ = warper_.step(scene_.deformed, target);
}

std::size_t WarpJob::output_bytes() const {
  return static_cast<std::size_t>(grid().voxel_count() * source_.components) *
         size_of(source_.type);
}

StepCheck check_step(const Workload& workload,
                     const VolumeView& source,
                     Filter filter,
                     const void* output,
                     const std::int32_t* owner,
                     const Counts& counts) {
  StepCheck check{compare(inputs().truth(workload), source, filter, output, owner), {}};
  check.fault = fault_of(check.accuracy, error_bound(source.type, filter), counts,
                         inputs().scene(workload), owner);
  return check;
}

}  // namespace tetwarp::bench
