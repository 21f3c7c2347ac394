/// @file warp_job.hpp
/// Inputs and steps that the rows of the warp benchmark share.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "bench/measure/floors.hpp"
#include "bench/warp/truth.hpp"
#include "bench/warp/workloads.hpp"

namespace tetwarp::bench {

/// Holds one scene, its truth and one image of it; a call for another workload replaces
/// them, so rows of one workload should follow each other.
class Inputs {
 public:
  const scenes::Scene& scene(const Workload& workload);
  const Truth& truth(const Workload& workload);
  VolumeView image(const Workload& workload,
                   PixelType type = PixelType::float32,
                   Image image = Image::textured,
                   int components = 1);

 private:
  std::string scene_name_, image_name_;
  scenes::Scene scene_;
  std::optional<Truth> truth_;
  Buffer image_;
};

/// The inputs of all rows of this program.
Inputs& inputs();

/// The sampling floor's map: that of the workload where it is one rotation, else a turn by five
/// degrees.
AffineRows floor_map(const Workload& workload);

/// A Warper and the memory of its output.
class WarpJob {
 public:
  /// @param options  the output grid is set to the scene's; expert.skip.unchanged_tets is turned
  /// off, so
  ///                 that every step with the same positions does all the work
  WarpJob(const scenes::Scene& scene,
          const VolumeView& source,
          WarpOptions options,
          const Mesh* mesh = nullptr);

  /// Warps to the scene's deformed positions; `target.volumes` is set here.
  const StepReport& step(WarpTarget target = {});

  const scenes::Scene& scene() const { return scene_; }
  const VolumeView& source() const { return source_; }
  const Grid& grid() const { return warper_.output_grid(); }
  std::byte* output() const { return output_.data(); }
  std::size_t output_bytes() const;
  std::int64_t covered() const { return last_.counts.covered; }

 private:
  const scenes::Scene& scene_;
  VolumeView source_;
  Warper warper_;
  Buffer output_;
  StepReport last_;
};

/// How a step's output and owners compare with the truth of its workload, and why they are wrong.
struct StepCheck {
  Accuracy accuracy;
  std::optional<std::string> fault;
};

/// @param output  samples of the source's type and components, background zero
/// @param counts  of the step that wrote `owner`
StepCheck check_step(const Workload& workload,
                     const VolumeView& source,
                     Filter filter,
                     const void* output,
                     const std::int32_t* owner,
                     const Counts& counts);

}  // namespace tetwarp::bench
