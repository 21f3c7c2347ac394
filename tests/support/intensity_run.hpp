/// @file intensity_run.hpp
/// One step of a warp with a choice of intensity.
#pragma once
#include <tetwarp/warp.hpp>

#include "tests/support/scenes.hpp"

namespace tetwarp::test {

/// A step with its whole report.
struct Step {
  Volume volume;
  StepReport report;
};

/// Warps `source` onto the output grid of a scene.
inline Step run(const Volume& source,
                const scenes::Scene& scene,
                Backend backend,
                Intensity intensity,
                WarpOptions options = {}) {
  options.backend = backend;
  options.intensity = intensity;
  options.output_grid = scene.output_grid;
  Warper warper(source, scene.mesh, options);
  Step step = {warper.step(scene.deformed), {}};
  step.report = warper.report().steps.front();
  return step;
}

}  // namespace tetwarp::test
