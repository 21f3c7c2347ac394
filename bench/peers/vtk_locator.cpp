#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkGenericCell.h>
#include <vtkImageData.h>
#include <vtkImageInterpolator.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>
#include <vtkStaticCellLocator.h>
#include <vtkUnstructuredGrid.h>

#include <memory>

#include "bench/peers/peer.hpp"

namespace tetwarp::bench {
namespace {
/// The deformed mesh in voxels of the output.
vtkSmartPointer<vtkUnstructuredGrid> deformed_grid(const scenes::Scene& scene) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToFloat();
  points->SetNumberOfPoints(static_cast<vtkIdType>(scene.deformed.size()));
  const Point3& origin = scene.output_grid.origin;
  for (std::size_t node = 0; node < scene.deformed.size(); ++node) {
    const Point3& p = scene.deformed[node];
    points->SetPoint(static_cast<vtkIdType>(node), p[0] - origin[0], p[1] - origin[1],
                     p[2] - origin[2]);
  }
  vtkNew<vtkCellArray> cells;
  for (const auto& tet : scene.mesh.tets) {
    const vtkIdType nodes[4] = {tet[0], tet[1], tet[2], tet[3]};
    cells->InsertNextCell(4, nodes);
  }
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  grid->SetPoints(points);
  grid->SetCells(VTK_TETRA, cells);
  return grid;
}

/// Keeps what does not change from step to step: the source and its interpolator.
class Locator {
 public:
  explicit Locator(const PeerInput& input) : input_(input) {
    const auto dims = input.source_dims();
    vtkNew<vtkFloatArray> samples;
    samples->SetArray(const_cast<float*>(input.source),
                      static_cast<vtkIdType>(input.scene.source_grid.voxel_count()), 1);
    source_->SetDimensions(dims.data());
    source_->GetPointData()->SetScalars(samples);
    interpolator_->SetInterpolationModeToLinear();
    interpolator_->SetBorderModeToClamp();
    interpolator_->SetTolerance(1.0);
    interpolator_->Initialize(source_);
    interpolator_->Update();
  }

  void step() {
    const vtkSmartPointer<vtkUnstructuredGrid> grid = deformed_grid(input_.scene);
    vtkNew<vtkStaticCellLocator> locator;
    locator->SetDataSet(grid);
    locator->BuildLocator();
    const auto dims = input_.output_dims();
    const vtkIdType rows = vtkIdType{dims[1]} * dims[2];
    // OpenMP, because vtkSMPTools.h of VTK 9.1 is not valid C++20.
#pragma omp parallel num_threads(input_.threads)
    {
      vtkNew<vtkGenericCell> cell;
#pragma omp for schedule(dynamic, 64)
      for (vtkIdType row = 0; row < rows; ++row) sample_row(row, locator, cell);
    }
  }

 private:
  void sample_row(vtkIdType row, vtkStaticCellLocator* locator, vtkGenericCell* cell) {
    const auto dims = input_.output_dims();
    const Mesh& mesh = input_.scene.mesh;
    const auto j = row % dims[1], k = row / dims[1];
    for (int i = 0; i < dims[0]; ++i) {
      double at[3] = {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
      double parametric[3], weights[8];
      const vtkIdType found = locator->FindCell(at, 0.0, cell, parametric, weights);
      float& value = input_.output[row * dims[0] + i];
      value = 0;
      if (found < 0) continue;
      float x[3] = {0, 0, 0};
      for (std::size_t n = 0; n < 4; ++n) {
        const auto node = static_cast<std::size_t>(mesh.tets[static_cast<std::size_t>(found)][n]);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          x[axis] += static_cast<float>(weights[n] * mesh.rest_positions[node][axis]);
        }
      }
      interpolator_->InterpolateIJK(x, &value);
    }
  }

  const PeerInput input_;
  vtkNew<vtkImageData> source_;
  vtkNew<vtkImageInterpolator> interpolator_;
};
}  // namespace

PeerStep vtk_locator(const PeerInput& input) {
  const auto locator = std::make_shared<Locator>(input);
  return [locator] { locator->step(); };
}

}  // namespace tetwarp::bench
