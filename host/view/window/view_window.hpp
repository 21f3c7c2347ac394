/// @file view_window.hpp
/// ViewWindow: the window of a live simulation.
#pragma once
#include <csignal>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>

#include "host/base/stopwatch.hpp"
#include "host/view/hand/device_hand.hpp"
#include "host/view/hand/scene_hand.hpp"
#include "host/view/live_simulation.hpp"
#include "host/view/view_scene.hpp"
#include "host/view/window/curve_panel.hpp"
#include "host/view/window/cut_plane.hpp"
#include "host/view/window/full_screen.hpp"
#include "host/view/window/mouse_style.hpp"
#include "host/view/window/picture_meter.hpp"
#include "host/view/window/pointer.hpp"
#include "host/view/window/scene_actors.hpp"
#include "host/view/window/screens.hpp"
#include "host/view/window/value_legend.hpp"
#include "host/view/window/volume_actors.hpp"
#include "host/view/window/window_film.hpp"
#include "host/view/window/window_texts.hpp"

namespace tetwarp::view {

/// All calls are from the main thread, the only one that uses VTK.
class ViewWindow {
 public:
  /// @param scene, simulation, options  kept by the caller
  /// @param screens  that show what this window does, or null; kept by the caller
  ViewWindow(const ViewScene& scene,
             LiveSimulation& simulation,
             const ViewOptions& options,
             MasterScreens* screens);

  /// Draws until the user, a signal or the last step ends it.
  /// @param is_interrupted  not 0: a signal ends it
  void run(const volatile std::sig_atomic_t& is_interrupted);
  /// Whether anything was drawn.
  bool has_picture() const { return volumes_.has_value(); }
  /// Writes what is shown. @pre has_picture() @throws IoError
  void save_picture(const std::string& path);
  const PictureMeter& pictures() const { return pictures_; }
  const InputDelay& delay() const { return delay_; }
  /// What ended the simulation, or empty.
  std::string failure();
  /// Why the film of the option is not complete, or empty.
  const std::string& film_failure() const { return film_.failure(); }

 private:
  void set_up_window();
  void set_up_mouse();
  void set_up_devices();
  bool update_devices();
  void on_timer();
  void draw();
  void set_up_drawing();
  void note_picture(double seconds);
  void refine();
  void tell_screens();
  void press(const PressedKey& key);
  void act(const std::string& key);
  void save_next_picture();
  bool let_go();
  void turn_grabbing();
  bool grab(int x, int y);
  bool move_slice(int x, int y, int steps);
  bool turn_window(int x, int y);
  void set_look(VolumeLook look);
  void note(const std::string& text);
  std::string overlay();
  void color_surfaces();
  void turn_film();
  void attempt(const std::function<void()>& action);

  const ViewScene& scene_;
  LiveSimulation& simulation_;
  const ViewOptions& options_;
  MasterScreens* screens_;
  vtkNew<vtkRenderer> renderer_;
  vtkNew<vtkRenderWindow> window_;
  vtkNew<vtkRenderWindowInteractor> events_;
  vtkNew<MouseStyle> style_;
  WindowTexts texts_{renderer_};
  std::optional<SceneActors> actors_;
  std::optional<VolumeActors> volumes_;
  VolumeLook look_ = VolumeLook::rays;
  SliceLook slices_;
  SurfaceQuantity quantity_;
  Pointer pointer_{renderer_};
  bool shows_contacts_ = true;
  bool may_grab_ = true;
  bool is_refined_ = false;  ///< more finely drawn since nothing moves
  RayQuality rays_;
  Stopwatch drawing_;  ///< since a picture was begun
  Stopwatch resting_;  ///< since the last picture of something that moved
  PictureMeter pictures_;
  InputDelay delay_;
  double level_ = 0, width_ = 1;  ///< of the window of volumes
  double grab_depth_ = 0;         ///< of the point that is held, as on the display
  std::string note_;
  std::optional<ValueLegend> legend_;
  std::optional<CurvePanel> curve_;
  WindowFilm film_;
  CutPlane cut_plane_;
  SceneHand hand_;
  std::optional<DeviceHand> devices_;
  FullScreen full_screen_{window_};
  const volatile std::sig_atomic_t* is_interrupted_ = nullptr;
};

}  // namespace tetwarp::view
