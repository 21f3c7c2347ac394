/// @file curve_panel.cpp
/// A rectangle, the line of opacities, and points in their colors.
#include "host/view/window/curve_panel.hpp"

#include <vtkCellArray.h>
#include <vtkPointData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty2D.h>

#include <array>
#include <utility>

namespace tetwarp::view {
namespace {
constexpr double width = 240, height = 110, margin = 12;  // [pixel]
constexpr double hue_pixels = 200;                        // for all hues

void add(vtkRenderer* renderer, vtkPolyData* data, vtkPoints* places, vtkActor2D* actor) {
  data->SetPoints(places);
  vtkNew<vtkPolyDataMapper2D> mapper;
  mapper->SetInputData(data);
  actor->SetMapper(mapper);
  actor->VisibilityOff();
  renderer->AddActor2D(actor);
}
}  // namespace

CurvePanel::CurvePanel(vtkRenderer* renderer) : renderer_(renderer) {
  add(renderer, frame_, frame_places_, frame_actor_);
  add(renderer, line_, line_places_, line_actor_);
  add(renderer, points_, point_places_, points_actor_);
  vtkNew<vtkCellArray> frame;
  frame->InsertNextCell({0, 1, 2, 3});
  frame_->SetPolys(frame);
  frame_places_->SetNumberOfPoints(4);
  frame_actor_->GetProperty()->SetColor(1, 1, 1);
  frame_actor_->GetProperty()->SetOpacity(0.75);
  line_actor_->GetProperty()->SetColor(0.2, 0.2, 0.25);
  line_actor_->GetProperty()->SetLineWidth(2);
  points_actor_->GetProperty()->SetPointSize(9);
  point_colors_->SetNumberOfComponents(3);
  points_->GetPointData()->SetScalars(point_colors_);
}

void CurvePanel::set_curve(std::vector<ColorPoint> curve) {
  editor_.emplace(std::move(curve));
}

std::array<double, 2> CurvePanel::corner() const {
  return {renderer_->GetSize()[0] - width - margin, margin};
}

std::array<double, 2> CurvePanel::share_of(int x, int y) const {
  const auto [left, bottom] = corner();
  return {(x - left) / width, (y - bottom) / height};
}

void CurvePanel::update() {
  const bool is_shown = is_shown_ && editor_;
  for (vtkActor2D* const actor : {frame_actor_.Get(), line_actor_.Get(), points_actor_.Get()}) {
    actor->SetVisibility(is_shown);
  }
  if (!is_shown) return;
  const auto [left, bottom] = corner();
  frame_places_->SetPoint(0, left, bottom, 0);
  frame_places_->SetPoint(1, left + width, bottom, 0);
  frame_places_->SetPoint(2, left + width, bottom + height, 0);
  frame_places_->SetPoint(3, left, bottom + height, 0);
  line_places_->Reset();
  point_places_->Reset();
  point_colors_->Reset();
  vtkNew<vtkCellArray> line, vertices;
  const std::vector<ColorPoint>& curve = editor_->curve();
  line->InsertNextCell(static_cast<int>(curve.size()));
  for (const ColorPoint& point : curve) {
    const double x = left + width * point.value, y = bottom + height * point.opacity;
    line->InsertCellPoint(line_places_->InsertNextPoint(x, y, 0));
    vertices->InsertNextCell({point_places_->InsertNextPoint(x, y, 0)});
    const auto& [red, green, blue] = point.color;
    point_colors_->InsertNextTuple3(255 * red, 255 * green, 255 * blue);
  }
  line_->SetLines(line);
  points_->SetVerts(vertices);
  frame_places_->Modified();
  line_places_->Modified();
  point_places_->Modified();
  point_colors_->Modified();
}

bool CurvePanel::press(int x, int y, bool tints) {
  const auto [share_x, share_y] = share_of(x, y);
  const bool is_on =
      is_shown_ && editor_ && share_x > -0.05 && share_x < 1.05 && share_y > -0.1 && share_y < 1.1;
  held_ = is_on ? editor_->hit(share_x, share_y) : std::nullopt;
  tints_ = tints;
  last_ = {x, y};
  return is_on;
}

bool CurvePanel::move(int x, int y) {
  if (!held_ || last_ == std::array{x, y}) return false;
  const auto [share_x, share_y] = share_of(x, y);
  if (tints_) {
    editor_->tint(*held_, (x - last_[0]) / hue_pixels, (y - last_[1]) / hue_pixels);
  } else {
    editor_->drag(*held_, share_x, share_y);
  }
  last_ = {x, y};
  return true;
}

}  // namespace tetwarp::view
