/// @file rest_growth.hpp
/// The growth of bodies that start smaller than they are: their rest size grows linearly in 0.2 s.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/start/start_shrink.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

/// Forces that let elastic bodies and cloth rest at a fraction of their size. An element that rests
/// at scale s has the stress 2 mu (e + 1 - s) + lambda (tr e + 3 (1 - s)), where e is its strain
/// relative to its full size. So the matrix of a step remains that of the full size, and the nodes
/// get the forces -V (2 mu + 3 lambda) (1 - s) R g_a. Springs of cloth get the tension k (1 - s) L.
/// All these forces sum to zero over a body.
class RestGrowth {
 public:
  static constexpr double duration = 0.2;  ///< [s]

  /// Nothing grows.
  RestGrowth() = default;
  /// @param full_start  positions of all nodes at full size, as ModelState::position
  RestGrowth(const SceneGeometry& geometry,
             const Model& model,
             const std::vector<Point3>& full_start,
             const std::vector<ShrunkBody>& bodies);

  /// Adds the forces at the end of the step to `block_force`, and changes the prescribed velocities
  /// of fixed and driven nodes so that these grow with their body. Does nothing if no body grows.
  /// @param input  filled for a step that begins in `state`
  void apply(const Model& model, const ModelState& state, StepInput& input) const;

  bool empty() const { return bodies_.empty(); }

 private:
  struct GrowingBody {
    ShrunkBody shrunk;
    std::vector<std::int32_t> tets, edges;    ///< of the model
    std::vector<std::int32_t> fixed, driven;  ///< nodes of the model
  };
  void add_forces(const GrowingBody& body,
                  double scale,
                  const Model& model,
                  const ModelState& state,
                  std::vector<Point3>& force) const;

  std::vector<GrowingBody> bodies_;
  std::vector<Point3> full_start_;
};

}  // namespace tetwarp
