/// @file surface_actor.cpp
/// Points and normals of a mesh that moves.
#include "host/view/window/surface_actor.hpp"

#include <vtkCellArray.h>
#include <vtkIdTypeArray.h>
#include <vtkPointData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>

#include "host/base/point3.hpp"

namespace tetwarp::view {
namespace {
constexpr double crease_angle = 40;  // degrees

vtkNew<vtkPolyData> mesh_of(const std::vector<Point3>& points, const Triangles& triangles) {
  vtkNew<vtkPoints> places;
  for (const Point3& x : points) places->InsertNextPoint(x.data());
  vtkNew<vtkCellArray> cells;
  for (const auto& triangle : triangles) {
    cells->InsertNextCell({triangle[0], triangle[1], triangle[2]});
  }
  vtkNew<vtkIdTypeArray> numbers;
  numbers->SetName("number");
  for (std::size_t p = 0; p < points.size(); ++p) {
    numbers->InsertNextValue(static_cast<vtkIdType>(p));
  }
  vtkNew<vtkPolyData> mesh;
  mesh->SetPoints(places);
  mesh->SetPolys(cells);
  mesh->GetPointData()->AddArray(numbers);
  return mesh;
}
/// @returns where the next one goes
float* write(const Point3& x, float* to) {
  for (const double part : x) *to++ = static_cast<float>(part);
  return to;
}
}  // namespace

SurfaceActor::SurfaceActor(const std::vector<Point3>& points,
                           const Triangles& triangles,
                           const Rgb& color) {
  vtkNew<vtkPolyDataNormals> divided;
  divided->SetInputData(mesh_of(points, triangles));
  divided->SetFeatureAngle(crease_angle);
  divided->SplittingOn();
  divided->ConsistencyOff();
  divided->Update();
  vtkPolyData* const drawn = divided->GetOutput();
  auto* const numbers = vtkIdTypeArray::SafeDownCast(drawn->GetPointData()->GetArray("number"));
  for (vtkIdType p = 0; p < drawn->GetNumberOfPoints(); ++p) {
    point_of_.push_back(static_cast<std::int32_t>(numbers->GetValue(p)));
  }
  for (vtkIdType c = 0; c < drawn->GetNumberOfCells(); ++c) {
    vtkIdType count = 0;
    const vtkIdType* nodes = nullptr;
    drawn->GetPolys()->GetCellAtId(c, count, nodes);
    auto& triangle = triangles_.emplace_back();
    for (std::size_t n = 0; n < 3; ++n) triangle[n] = static_cast<std::int32_t>(nodes[n]);
  }
  places_->SetDataTypeToFloat();
  places_->SetNumberOfPoints(drawn->GetNumberOfPoints());
  normals_->SetNumberOfComponents(3);
  normals_->SetNumberOfTuples(drawn->GetNumberOfPoints());
  colors_->SetNumberOfComponents(3);
  colors_->SetNumberOfTuples(drawn->GetNumberOfPoints());
  mesh_->GetPointData()->SetScalars(colors_);
  mesh_->SetPoints(places_);
  mesh_->SetPolys(drawn->GetPolys());
  mesh_->GetPointData()->SetNormals(normals_);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(mesh_);
  mapper->ScalarVisibilityOff();
  actor_->SetMapper(mapper);
  vtkProperty* const look = actor_->GetProperty();
  look->SetColor(color[0], color[1], color[2]);
  look->SetAmbient(0.15);
  look->SetDiffuse(0.85);
  look->SetSpecular(0.15);
  look->SetSpecularPower(30);
  move(points);
}

void SurfaceActor::move(const std::vector<Point3>& points) {
  if (points == points_) return;
  points_ = points;
  float* to = static_cast<float*>(places_->GetVoidPointer(0));
  for (const std::int32_t point : point_of_) to = write(at(points_, point), to);
  compute_normals();
  places_->Modified();
  normals_->Modified();
  mesh_->Modified();
}

void SurfaceActor::set_colors(const std::vector<Rgb>& colors) {
  actor_->GetMapper()->SetScalarVisibility(!colors.empty());
  if (colors.empty()) return;
  for (std::size_t p = 0; p < point_of_.size(); ++p) {
    const auto& [red, green, blue] = colors[static_cast<std::size_t>(point_of_[p])];
    colors_->SetTuple3(static_cast<vtkIdType>(p), 255 * red, 255 * green, 255 * blue);
  }
  colors_->Modified();
  mesh_->Modified();
}

void SurfaceActor::compute_normals() {
  std::vector<Point3> sums(point_of_.size(), {0, 0, 0});
  const auto corner = [&](std::int32_t drawn) -> const Point3& {
    return at(points_, at(point_of_, drawn));
  };
  for (const auto& [a, b, c] : triangles_) {
    const Point3& first = corner(a);
    const Point3 normal = cross(minus(corner(b), first), minus(corner(c), first));
    for (const std::int32_t point : {a, b, c}) {
      Point3& sum = sums[static_cast<std::size_t>(point)];
      sum = plus(sum, normal);
    }
  }
  float* to = normals_->GetPointer(0);
  for (const Point3& sum : sums) to = write(unit(sum), to);
}

}  // namespace tetwarp::view
