/// @file scene_actors.cpp
/// Meshes, planes and arrows.
#include "host/view/window/scene_actors.hpp"

#include <vtkArrowSource.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkPointData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkSphereSource.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "host/base/point3.hpp"
#include "host/view/look/obstacle_surface.hpp"

namespace tetwarp::view {
namespace {
constexpr Rgb contact_color{0.85, 0.10, 0.45}, held_color{0.10, 0.55, 0.20};
constexpr Rgb ray_color{0.10, 0.35, 0.90};
constexpr double longest_arrow = 0.15, ball_radius = 0.003;  // of the size of the scene
constexpr int plane_squares = 24;
constexpr double plane_size = 4;  // of the size of the scene

void set_arrows(ArrowActors& of, const std::vector<ContactArrow>& arrows) {
  of.places->Reset();
  of.vectors->Reset();
  for (const ContactArrow& arrow : arrows) {
    of.places->InsertNextPoint(arrow.position.data());
    of.vectors->InsertNextTuple(arrow.force.data());
  }
  of.places->Modified();
  of.vectors->Modified();
  of.data->Modified();
}
}  // namespace

SceneActors::SceneActors(const ViewScene& scene, const LiveFrame& frame, vtkRenderer* renderer)
    : scene_(scene) {
  for (std::size_t b = 0; b < scene.triangles.size(); ++b) {
    bodies_.emplace_back(frame.points[b], scene.triangles[b], color_of(b));
    renderer->AddActor(bodies_.back().actor());
  }
  for (std::size_t o = 0; o < scene.obstacles.size(); ++o) {
    if (const auto plane = plane_of(scene.obstacles[o], frame.time)) add_plane(*plane, renderer);
    const auto surface = surface_of(scene.obstacles[o], frame.time);
    if (!surface) continue;
    obstacles_.emplace_back(o, SurfaceActor(surface->points, surface->triangles, obstacle_color));
    renderer->AddActor(obstacles_.back().second.actor());
  }
  add_arrows(contacts_, contact_color, renderer);
  add_arrows(held_, held_color, renderer);
  add_rays(renderer);
}

/// A checker board around the foot of the scene's center.
void SceneActors::add_plane(const DrawnPlane& plane, vtkRenderer* renderer) {
  const Point3 n = unit(plane.normal);
  const Point3 u = unit(cross(n, std::abs(n[0]) < 0.9 ? Point3{1, 0, 0} : Point3{0, 1, 0}));
  const Point3 v = cross(n, u);
  const Point3 foot = minus(scene_.center, times(dot(minus(scene_.center, plane.point), n), n));
  const double edge = plane_size * scene_.size / plane_squares;
  vtkNew<vtkPoints> places;
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkUnsignedCharArray> colors;
  colors->SetNumberOfComponents(3);
  for (int row = 0; row <= plane_squares; ++row) {
    for (int column = 0; column <= plane_squares; ++column) {
      const Point3 x = plus(foot, plus(times((column - plane_squares / 2.0) * edge, u),
                                       times((row - plane_squares / 2.0) * edge, v)));
      const vtkIdType corner = places->InsertNextPoint(x.data());
      if (row == plane_squares || column == plane_squares) continue;
      const vtkIdType above = corner + plane_squares + 1;
      cells->InsertNextCell({corner, corner + 1, above + 1, above});
      const double gray = (row + column) % 2 == 0 ? 205 : 190;
      colors->InsertNextTuple3(gray, gray, gray);
    }
  }
  vtkNew<vtkPolyData> mesh;
  mesh->SetPoints(places);
  mesh->SetPolys(cells);
  mesh->GetCellData()->SetScalars(colors);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(mesh);
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->BackfaceCullingOn();
  renderer->AddActor(actor);
}

void SceneActors::add_arrows(ArrowActors& of, const Rgb& color, vtkRenderer* renderer) {
  of.vectors->SetNumberOfComponents(3);
  of.vectors->SetName("force");
  of.data->SetPoints(of.places);
  of.data->GetPointData()->AddArray(of.vectors);
  vtkNew<vtkArrowSource> arrow;
  arrow->SetTipResolution(6);  // few sides: a picture may have thousands
  arrow->SetShaftResolution(4);
  of.arrow_mapper->SetInputData(of.data);
  of.arrow_mapper->SetSourceConnection(arrow->GetOutputPort());
  of.arrow_mapper->SetOrientationArray("force");
  of.arrow_mapper->SetScaleArray("force");
  of.arrow_mapper->SetScaleModeToScaleByMagnitude();
  vtkNew<vtkSphereSource> ball;
  ball->SetRadius(ball_radius * scene_.size);
  ball->SetThetaResolution(6);
  ball->SetPhiResolution(4);
  of.ball_mapper->SetInputData(of.data);
  of.ball_mapper->SetSourceConnection(ball->GetOutputPort());
  of.ball_mapper->ScalingOff();
  of.ball_mapper->OrientOff();
  of.arrows->SetMapper(of.arrow_mapper);
  of.balls->SetMapper(of.ball_mapper);
  for (vtkActor* const actor : {of.arrows.Get(), of.balls.Get()}) {
    actor->GetProperty()->SetColor(color[0], color[1], color[2]);
    renderer->AddActor(actor);
  }
}

void SceneActors::add_rays(vtkRenderer* renderer) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(rays_);
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(ray_color[0], ray_color[1], ray_color[2]);
  actor->GetProperty()->SetLineWidth(2);
  actor->GetProperty()->LightingOff();
  renderer->AddActor(actor);
}

void SceneActors::show_rays(const std::vector<WandRay>& rays) {
  vtkNew<vtkPoints> ends;
  vtkNew<vtkCellArray> lines;
  for (const auto& [from, to] : rays) {
    const vtkIdType first = ends->InsertNextPoint(from.data());
    lines->InsertNextCell({first, ends->InsertNextPoint(to.data())});
  }
  rays_->SetPoints(ends);
  rays_->SetLines(lines);
}

/// Points without a value have the color of their body.
void SceneActors::color_bodies(const LiveFrame& frame) {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    std::vector<Rgb> colors;
    if (b < frame.values.size()) {
      for (const float value : frame.values[b]) {
        colors.push_back(std::isnan(value) ? color_of(b) : value_color(frame.range.share(value)));
      }
    }
    bodies_[b].set_colors(colors);
  }
}

void SceneActors::show(const LiveFrame& frame) {
  for (std::size_t b = 0; b < bodies_.size(); ++b) bodies_[b].move(frame.points[b]);
  color_bodies(frame);
  for (auto& [number, actor] : obstacles_) {
    const Obstacle& obstacle = scene_.obstacles[number];
    if (!obstacle.path.empty()) actor.move(surface_of(obstacle, frame.time)->points);
  }
  for (const ContactArrow& contact : frame.contacts) {
    largest_force_ = std::max(largest_force_, norm(contact.force));
  }
  const double longest = longest_arrow * scene_.size;
  contacts_.arrow_mapper->SetScaleFactor(largest_force_ > 0 ? longest / largest_force_ : 1);
  set_arrows(contacts_, frame.contacts);
  held_.arrow_mapper->SetScaleFactor(1);
  set_arrows(held_, {});
  if (frame.grab) {
    const Point3 way = minus(frame.grab->target, frame.grab->point);
    set_arrows(held_, {{frame.grab->point, way}});
  }
}

void SceneActors::show_contacts(bool are_shown) {
  contacts_.arrows->SetVisibility(are_shown);
  contacts_.balls->SetVisibility(are_shown);
}

void SceneActors::show_body(std::size_t body, bool is_shown) {
  bodies_[body].actor()->SetVisibility(is_shown);
}

}  // namespace tetwarp::view
