/// @file volume_actors.cpp
/// Images, rays and slices of warped volumes.
#include "host/view/window/volume_actors.hpp"

#include <vtkCullerCollection.h>
#include <vtkFrustumCoverageCuller.h>
#include <vtkImageProperty.h>
#include <vtkPointData.h>
#include <vtkVolumeProperty.h>

#include <array>

namespace tetwarp::view {
namespace {
constexpr int gray_levels = 256, clear_levels = 8;  // of slices; the darkest are clear
}  // namespace

VolumeActors::VolumeActors(const ViewScene& scene,
                           const std::string& preset,
                           vtkRenderer* renderer) {
  for (const VolumeBody& body : scene.volumes) {
    Drawn& drawn = drawn_.emplace_back(VolumeColors(preset, body.low, body.high));
    drawn.image->GetPointData()->SetScalars(drawn.samples);
    drawn.mapper->SetInputData(drawn.image);
    drawn.mapper->AutoAdjustSampleDistancesOff();
    drawn.rays->SetMapper(drawn.mapper);
    vtkVolumeProperty* const look = drawn.rays->GetProperty();
    look->SetColor(drawn.color);
    look->SetScalarOpacity(drawn.opacity);
    look->SetInterpolationTypeToLinear();
    look->ShadeOff();
    drawn.gray->SetNumberOfTableValues(gray_levels);
    for (int level = 0; level < gray_levels; ++level) {
      const double share = static_cast<double>(level) / (gray_levels - 1);
      drawn.gray->SetTableValue(level, share, share, share, level < clear_levels ? 0 : 1);
    }
    for (int axis = 0; axis < 3; ++axis) {
      drawn.slice_mappers[axis]->SetInputData(drawn.image);
      drawn.slice_mappers[axis]->SetOrientation(axis);
      drawn.slices[axis]->SetMapper(drawn.slice_mappers[axis]);
      drawn.slices[axis]->GetProperty()->SetLookupTable(drawn.gray);
      drawn.slices[axis]->GetProperty()->UseLookupTableScalarRangeOn();
      drawn.slices[axis]->VisibilityOff();
      renderer->AddViewProp(drawn.slices[axis]);
    }
    drawn.rays->VisibilityOff();
    renderer->AddVolume(drawn.rays);
    color(drawn);
  }
  // Volumes are blended over what was drawn before them.
  vtkCullerCollection* const cullers = renderer->GetCullers();
  cullers->InitTraversal();
  while (vtkCuller* const culler = cullers->GetNextItem()) {
    auto* const sorting = vtkFrustumCoverageCuller::SafeDownCast(culler);
    if (sorting != nullptr) sorting->SetSortingStyleToBackToFront();
  }
}

void VolumeActors::color(Drawn& drawn) {
  drawn.color->RemoveAllPoints();
  drawn.opacity->RemoveAllPoints();
  for (const ColorPoint& point : drawn.colors.points()) {
    const auto& [red, green, blue] = point.color;
    drawn.color->AddRGBPoint(point.value, red, green, blue);
    drawn.opacity->AddPoint(point.value, point.opacity);
  }
  const std::array<double, 2> gray = drawn.colors.gray();
  drawn.gray->SetTableRange(gray.data());
}

void VolumeActors::show(LiveFrame& frame) {
  for (std::size_t v = 0; v < drawn_.size(); ++v) {
    Drawn& drawn = drawn_[v];
    drawn.has_samples = v < frame.volumes.size();
    if (drawn.has_samples) {
      VolumeFrame& volume = frame.volumes[v];
      const Grid& grid = volume.grid;
      drawn.image->SetDimensions(static_cast<int>(grid.dims[0]), static_cast<int>(grid.dims[1]),
                                 static_cast<int>(grid.dims[2]));
      drawn.image->SetOrigin(grid.origin.data());
      drawn.image->SetSpacing(grid.spacing.data());
      drawn.samples->SetArray(volume.samples.data(), static_cast<vtkIdType>(volume.samples.size()),
                              1);
      drawn.samples->Modified();
      drawn.image->Modified();
      space_rays(drawn);
      drawn.rays->GetProperty()->SetScalarOpacityUnitDistance(preset_length(grid));
      drawn.grid = grid;
      place_slices(drawn);
    }
    show_look(drawn);
  }
}

void VolumeActors::set_rays(const RaySpacing& spacing) {
  rays_ = spacing;
  for (Drawn& drawn : drawn_) {
    if (drawn.has_samples) space_rays(drawn);
  }
}

void VolumeActors::space_rays(Drawn& drawn) {
  drawn.mapper->SetSampleDistance(static_cast<float>(rays_.step * drawn.image->GetSpacing()[0]));
  drawn.mapper->SetImageSampleDistance(static_cast<float>(rays_.pixels));
}

void VolumeActors::set_look(VolumeLook look) {
  look_ = look;
  for (Drawn& drawn : drawn_) show_look(drawn);
}

void VolumeActors::show_look(Drawn& drawn) {
  drawn.rays->SetVisibility(drawn.has_samples && look_ == VolumeLook::rays);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    drawn.slices[axis]->SetVisibility(drawn.has_samples && look_ == VolumeLook::slices &&
                                      slices_.shows(axis));
  }
}

void VolumeActors::set_slices(const SliceLook& slices) {
  slices_ = slices;
  for (Drawn& drawn : drawn_) {
    if (drawn.has_samples) place_slices(drawn);
    show_look(drawn);
  }
}

void VolumeActors::place_slices(Drawn& drawn) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t number = slice_number(drawn.grid, axis, slices_.places[axis]);
    drawn.slice_mappers[axis]->SetSliceNumber(static_cast<int>(number));
  }
}

void VolumeActors::set_curve(const std::vector<ColorPoint>& curve) {
  for (Drawn& drawn : drawn_) {
    drawn.colors.set_curve(curve);
    color(drawn);
  }
}

void VolumeActors::set_window(double level, double width) {
  for (Drawn& drawn : drawn_) {
    drawn.colors.set_window(level, width);
    color(drawn);
  }
}

}  // namespace tetwarp::view
