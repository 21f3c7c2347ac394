/// @file inputs.hpp
/// Inputs of the rows, each made once for all rows in succession that use it.
#pragma once
#include <optional>
#include <string>

#include "bench/truth.hpp"
#include "bench/workloads.hpp"

namespace tetwarp::bench {

/// Holds one scene, its truth and one image of it; asking for others replaces them.
class Inputs {
 public:
  const scenes::Scene& scene(const Workload& workload) {
    if (scene_name_ != workload.name) {
      scene_name_ = workload.name;
      scene_ = make_scene(workload);
      truth_.reset();
      image_name_.clear();
    }
    return scene_;
  }

  const Truth& truth(const Workload& workload) {
    const scenes::Scene& made = scene(workload);
    if (!truth_) truth_ = make_truth(made);
    return *truth_;
  }

  VolumeView image(const Workload& workload, PixelType type, Image image, int components = 1) {
    const Grid& grid = scene(workload).source_grid;
    const std::string name = std::string(name_of(type)) + "/" + std::to_string(components) + "/" +
                             std::to_string(static_cast<int>(image));
    if (image_name_ != name) {
      image_ = Buffer();  // before the next one: two large images need not fit
      image_ = make_image(grid, type, image, components);
      image_name_ = name;
    }
    return {grid, type, components, image_.data(), Memory::host};
  }

 private:
  std::string scene_name_, image_name_;
  scenes::Scene scene_;
  std::optional<Truth> truth_;
  Buffer image_;
};

/// The inputs of all rows of this program.
inline Inputs& inputs() {
  static Inputs held;
  return held;
}

}  // namespace tetwarp::bench
