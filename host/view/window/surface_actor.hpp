/// @file surface_actor.hpp
/// SurfaceActor: a triangle mesh in the window whose points move.
#pragma once
#include <cstdint>
#include <vector>

#include <vtkActor.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnsignedCharArray.h>

#include "host/view/look/scene_look.hpp"
#include "host/view/pick.hpp"

namespace tetwarp::view {

/// Shaded smoothly, except across creases of more than 40 degrees at the start.
class SurfaceActor {
 public:
  SurfaceActor(const std::vector<Point3>& points, const Triangles& triangles, const Rgb& color);

  /// Does nothing where nothing has moved.
  /// @param points  as many as at the start [world]
  void move(const std::vector<Point3>& points);
  /// @param colors  of the points at the start; empty: the surface has its own color
  void set_colors(const std::vector<Rgb>& colors);
  vtkActor* actor() { return actor_; }

 private:
  void compute_normals();

  std::vector<std::int32_t>
      point_of_;                ///< [drawn points]: points at creases are drawn several times
  Triangles triangles_;         ///< of drawn points
  std::vector<Point3> points_;  ///< where they are now, each once
  vtkNew<vtkPoints> places_;
  vtkNew<vtkFloatArray> normals_;
  vtkNew<vtkUnsignedCharArray> colors_;
  vtkNew<vtkPolyData> mesh_;
  vtkNew<vtkActor> actor_;
};

}  // namespace tetwarp::view
