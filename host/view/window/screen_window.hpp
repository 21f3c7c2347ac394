/// @file screen_window.hpp
/// ScreenWindow: one screen of a room, which follows a master.
#pragma once
#include <array>
#include <csignal>
#include <cstdint>
#include <optional>
#include <string>

#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>

#include "host/view/link/screen_link.hpp"
#include "host/view/live_volumes.hpp"
#include "host/view/screens/shared_state.hpp"
#include "host/view/view_scene.hpp"
#include "host/view/window/cut_plane.hpp"
#include "host/view/window/scene_actors.hpp"
#include "host/view/window/volume_actors.hpp"

namespace tetwarp::view {

/// Draws each frame to the back buffer, says so, and shows it when the master says so.
class ScreenWindow {
 public:
  /// @param options  address of the master, name of the screen; kept by the caller
  /// @param keys     of the screens, or none
  ScreenWindow(const ViewOptions& options, const ScreenKeys& keys);

  /// @throws std::runtime_error  the master refuses, or the screen's stereo is impossible here
  void run(const volatile std::sig_atomic_t& is_interrupted);

 private:
  void receive(ToScreen message);
  void join();
  void welcome(WelcomeMessage message);
  void set_up_window(const Screen& screen);
  void load(SharedScene scene);
  void draw(const FrameMessage& message);
  void show_state(const FrameMessage& message);
  void set_eye();
  void set_light(const RoomPlace& place);

  const ViewOptions& options_;
  ScreenLink link_;
  vtkNew<vtkRenderer> renderer_;
  vtkNew<vtkRenderWindow> window_;
  vtkNew<vtkRenderWindowInteractor> events_;
  vtkNew<vtkLight> light_;

  std::uint64_t session_ = 0;
  Screen screen_;
  bool is_open_ = false, has_shown_ = false, is_over_ = false;
  RayQuality rays_;
  std::uint64_t drawn_ = 0;  ///< frame in the back buffer; 0: none
  std::array<Point3, 2> eyes_{};
  RoomPlace place_;
  Bytes state_bytes_;  ///< of the state that is loaded

  SharedScene shared_;
  ViewScene scene_;
  LiveFrame frame_;
  std::optional<LiveVolumes> warps_;
  std::optional<SceneActors> actors_;
  std::optional<VolumeActors> volumes_;
  CutPlane cut_;
};

}  // namespace tetwarp::view
