/// @file scene_actors.hpp
/// SceneActors: bodies, obstacles, contacts and what the mouse holds.
#pragma once
#include <cstddef>
#include <deque>
#include <utility>
#include <vector>

#include <vtkActor.h>
#include <vtkDoubleArray.h>
#include <vtkGlyph3DMapper.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>

#include "host/view/hand/room_place.hpp"
#include "host/view/live_frame.hpp"
#include "host/view/view_scene.hpp"
#include "host/view/window/surface_actor.hpp"

namespace tetwarp::view {

/// Vectors at points as arrows, and the points as balls.
struct ArrowActors {
  vtkNew<vtkPoints> places;
  vtkNew<vtkDoubleArray> vectors;
  vtkNew<vtkPolyData> data;
  vtkNew<vtkGlyph3DMapper> arrow_mapper, ball_mapper;
  vtkNew<vtkActor> arrows, balls;
};

class SceneActors {
 public:
  /// @param scene  kept by the caller
  /// @param frame  the first one
  SceneActors(const ViewScene& scene, const LiveFrame& frame, vtkRenderer* renderer);

  void show(const LiveFrame& frame);
  void show_contacts(bool are_shown);
  void show_rays(const std::vector<WandRay>& rays);
  /// Whether the surface of a body is drawn.
  void show_body(std::size_t body, bool is_shown);

 private:
  void add_plane(const DrawnPlane& plane, vtkRenderer* renderer);
  void color_bodies(const LiveFrame& frame);
  void add_arrows(ArrowActors& of, const Rgb& color, vtkRenderer* renderer);
  void add_rays(vtkRenderer* renderer);

  const ViewScene& scene_;
  std::deque<SurfaceActor> bodies_;
  std::deque<std::pair<std::size_t, SurfaceActor>> obstacles_;  ///< number in the scene, mesh
  ArrowActors contacts_, held_;
  double largest_force_ = 0;  ///< of a contact so far [N]
  vtkNew<vtkPolyData> rays_;
};

}  // namespace tetwarp::view
