/// @file volume_actors.hpp
/// VolumeActors: warped volumes as ray casts or as slices.
#pragma once
#include <deque>
#include <string>
#include <vector>

#include <vtkColorTransferFunction.h>
#include <vtkGPUVolumeRayCastMapper.h>
#include <vtkImageData.h>
#include <vtkImageSlice.h>
#include <vtkImageSliceMapper.h>
#include <vtkLookupTable.h>
#include <vtkNew.h>
#include <vtkPiecewiseFunction.h>
#include <vtkRenderer.h>
#include <vtkShortArray.h>
#include <vtkVolume.h>

#include "host/view/live_frame.hpp"
#include "host/view/look/slice_look.hpp"
#include "host/view/ray_quality.hpp"
#include "host/view/view_scene.hpp"
#include "host/view/volume_colors.hpp"

namespace tetwarp::view {

enum class VolumeLook { rays, slices, surfaces };

class VolumeActors {
 public:
  VolumeActors(const ViewScene& scene, const std::string& preset, vtkRenderer* renderer);

  /// @param frame  its samples are drawn where they are, until the next call
  void show(LiveFrame& frame);
  void set_look(VolumeLook look);
  void set_slices(const SliceLook& slices);
  void set_rays(const RaySpacing& spacing);
  /// Of the first volume. @pre there is one
  std::vector<ColorPoint> curve() const { return drawn_.front().colors.curve(); }
  /// Of all volumes, as VolumeColors::set_curve().
  void set_curve(const std::vector<ColorPoint>& curve);
  /// As VolumeColors::set_window().
  void set_window(double level, double width);

 private:
  struct Drawn {
    explicit Drawn(VolumeColors own) : colors(std::move(own)) {}
    VolumeColors colors;
    vtkNew<vtkImageData> image;
    vtkNew<vtkShortArray> samples;
    vtkNew<vtkGPUVolumeRayCastMapper> mapper;
    vtkNew<vtkVolume> rays;
    vtkNew<vtkColorTransferFunction> color;
    vtkNew<vtkPiecewiseFunction> opacity;
    vtkNew<vtkLookupTable> gray;  ///< of slices
    vtkNew<vtkImageSliceMapper> slice_mappers[3];
    vtkNew<vtkImageSlice> slices[3];
    Grid grid;
    bool has_samples = false;
  };
  void color(Drawn& drawn);
  void space_rays(Drawn& drawn);
  void show_look(Drawn& drawn);
  void place_slices(Drawn& drawn);

  std::deque<Drawn> drawn_;  ///< [volumes]
  VolumeLook look_ = VolumeLook::rays;
  SliceLook slices_;
  RaySpacing rays_;
};

}  // namespace tetwarp::view
