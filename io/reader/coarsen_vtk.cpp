/// @file coarsen_vtk.cpp
/// Decimation, with an error bound that falls until the measured distance is met.
#include <vtkCellArray.h>
#include <vtkCellLocator.h>
#include <vtkDecimatePro.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <tetwarp/error.hpp>

#include "io/reader/mesh_readers.hpp"

namespace tetwarp {
namespace {
constexpr int most_tries = 12;

vtkSmartPointer<vtkPolyData> read_handed(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::uint64_t counts[2] = {0, 0};
  in.read(reinterpret_cast<char*>(counts), sizeof counts);
  const vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (std::uint64_t p = 0; in && p < counts[0]; ++p) {
    double x[3];
    in.read(reinterpret_cast<char*>(x), sizeof x);
    points->InsertNextPoint(x);
  }
  const vtkNew<vtkCellArray> triangles;
  for (std::uint64_t t = 0; in && t < counts[1]; ++t) {
    std::int32_t corners[3];
    in.read(reinterpret_cast<char*>(corners), sizeof corners);
    const vtkIdType ids[3] = {corners[0], corners[1], corners[2]};
    triangles->InsertNextCell(3, ids);
  }
  if (!in) throw IoError(path, "", "ends too early");
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  surface->SetPoints(points);
  surface->SetPolys(triangles);
  return surface;
}

double distance_to(vtkCellLocator& locator, const double* x) {
  double nearest[3], squared = 0;
  vtkIdType cell = 0;
  int part = 0;
  locator.FindClosestPoint(x, nearest, cell, part, squared);
  return std::sqrt(squared);
}

/// Largest distance of the points and of the middles of triangles of one surface from another.
double distance_from(vtkPolyData& of, vtkPolyData& from) {
  const vtkNew<vtkCellLocator> locator;
  locator->SetDataSet(&from);
  locator->BuildLocator();
  double largest = 0, x[3];
  for (vtkIdType p = 0; p < of.GetNumberOfPoints(); ++p) {
    of.GetPoint(p, x);
    largest = std::max(largest, distance_to(*locator, x));
  }
  const vtkNew<vtkIdList> corners;
  for (vtkIdType c = 0; c < of.GetNumberOfCells(); ++c) {
    of.GetCellPoints(c, corners);
    double middle[3] = {0, 0, 0};
    for (vtkIdType n = 0; n < corners->GetNumberOfIds(); ++n) {
      of.GetPoint(corners->GetId(n), x);
      for (int d = 0; d < 3; ++d) middle[d] += x[d] / 3;
    }
    largest = std::max(largest, distance_to(*locator, middle));
  }
  return largest;
}

CoarseMesh mesh_of(vtkPolyData& surface) {
  CoarseMesh mesh;
  mesh.points.resize(static_cast<std::size_t>(surface.GetNumberOfPoints()));
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    surface.GetPoint(static_cast<vtkIdType>(p), mesh.points[p].data());
  }
  const vtkNew<vtkIdList> corners;
  for (vtkIdType c = 0; c < surface.GetNumberOfCells(); ++c) {
    surface.GetCellPoints(c, corners);
    if (corners->GetNumberOfIds() != 3) continue;
    mesh.triangles.push_back({static_cast<std::int32_t>(corners->GetId(0)),
                              static_cast<std::int32_t>(corners->GetId(1)),
                              static_cast<std::int32_t>(corners->GetId(2))});
  }
  return mesh;
}
}  // namespace

CoarseMesh coarsen_by_vtk(const std::string& path, double distance) {
  const vtkSmartPointer<vtkPolyData> fine = read_handed(path);
  double bound = distance;
  for (int n = 0; n < most_tries; ++n, bound /= 2) {
    const vtkNew<vtkDecimatePro> decimation;
    decimation->SetInputData(fine);
    decimation->SetTargetReduction(1);
    decimation->PreserveTopologyOn();
    decimation->SplittingOff();
    decimation->BoundaryVertexDeletionOff();
    decimation->AccumulateErrorOn();
    decimation->SetErrorIsAbsolute(1);
    decimation->SetAbsoluteError(bound);
    decimation->SetMaximumError(VTK_DOUBLE_MAX);
    decimation->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    decimation->Update();
    vtkPolyData& coarse = *decimation->GetOutput();
    if (coarse.GetNumberOfCells() < 4) continue;
    if (distance_from(*fine, coarse) <= distance && distance_from(coarse, *fine) <= distance) {
      return mesh_of(coarse);
    }
  }
  return mesh_of(*fine);
}

}  // namespace tetwarp
