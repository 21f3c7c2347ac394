/// @file body_models.hpp
/// Small models for tests of steppers, made by hand.
#pragma once
#include <array>
#include <cstdint>

#include "host/simulate/model/model.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp::test {

struct BlockOptions {
  std::array<int, 3> cells{2, 2, 2};
  double edge = 0.1;       ///< of a cell [m]
  double jitter = 0;       ///< of inner nodes, in edges
  Point3 origin{0, 0, 0};  ///< [m]
  double youngs = 1e5, poisson = 0.3, density = 1000, gamma = 0;
};

/// A model of nothing; bodies are appended to it.
Model empty_model();
/// Appends a block of cubes of five tetrahedra with consistent mass as a body of its own island.
/// Nodes are numbered x fastest. @returns its first node
std::int32_t add_block(Model& model, const BlockOptions& options);
/// Appends a rigid body of its own island; before any rigid body, all blocks have been added.
/// @returns its number
std::int32_t add_rigid(Model& model, double mass, const Point3& moments, const Point3& center);
/// Appends a spring; the islands of both bodies become one.
void add_spring(
    Model& model, const ModelPoint& a, const ModelPoint& b, double stiffness, double damping = 0);
/// Appends cloth: edges of a square grid in the plane z = 0 with lumped mass.
std::int32_t add_sheet(Model& model, int cells, double edge, double stiffness, double mass);

ModelPoint node_point(const Model& model, std::int32_t node);
ModelPoint rigid_point(const Model& model, std::int32_t rigid, const Point3& local);
ModelPoint world_point(const Point3& position);

/// Rests, without loads.
StepInput input_for(const Model& model, double time_step, const Point3& gravity = {0, 0, 0});

ModelState state_of(const BodyStepper& stepper);
double distance(const Point3& a, const Point3& b);
double kinetic_energy(const Model& model, const ModelState& state);
/// V (mu |e|^2 + lambda / 2 tr(e)^2) summed, rotations by Eigen's singular values.
double elastic_energy(const Model& model, const ModelState& state);
Point3 momentum(const Model& model, const ModelState& state);
/// Of nodes, about the origin.
Point3 angular_momentum(const Model& model, const ModelState& state);
int inverted_count(const Model& model, const ModelState& state);

}  // namespace tetwarp::test
