/// @file cut_plane.cpp
/// Clipping planes of mappers.
#include "host/view/window/cut_plane.hpp"

#include <vtkAbstractVolumeMapper.h>
#include <vtkActor.h>
#include <vtkActorCollection.h>
#include <vtkCamera.h>
#include <vtkMapper.h>
#include <vtkPlaneCollection.h>
#include <vtkVolume.h>
#include <vtkVolumeCollection.h>

#include "host/base/point3.hpp"

namespace tetwarp::view {

void CutPlane::turn(const Point3& point, vtkRenderer* renderer) {
  if (cut_) return set(std::nullopt, renderer);
  Point3 away{};
  renderer->GetActiveCamera()->GetViewPlaneNormal(away.data());
  set(Cut{point, unit(away)}, renderer);
}

void CutPlane::move(double way, vtkRenderer* renderer) {
  if (!cut_) return;
  set(Cut{minus(cut_->point, times(way, cut_->normal)), cut_->normal}, renderer);
}

void CutPlane::set(const std::optional<Cut>& cut, vtkRenderer* renderer) {
  cut_ = cut;
  if (cut) {
    plane_->SetOrigin(cut->point.data());
    plane_->SetNormal(times(-1, cut->normal).data());
  }
  const auto set_on = [&](vtkAbstractMapper* mapper) {
    vtkPlaneCollection* const planes = mapper->GetClippingPlanes();
    const bool has_plane = planes != nullptr && planes->IsItemPresent(plane_) != 0;
    if (has_plane && !cut) mapper->RemoveClippingPlane(plane_);
    if (!has_plane && cut) mapper->AddClippingPlane(plane_);
  };
  vtkActorCollection* const actors = renderer->GetActors();
  actors->InitTraversal();
  while (vtkActor* const actor = actors->GetNextActor()) set_on(actor->GetMapper());
  vtkVolumeCollection* const volumes = renderer->GetVolumes();
  volumes->InitTraversal();
  while (vtkVolume* const volume = volumes->GetNextVolume()) set_on(volume->GetMapper());
}

}  // namespace tetwarp::view
