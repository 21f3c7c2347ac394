/// @file screens.hpp
/// The screens of a room, which processes of their own draw. Without ZeroMQ all of it throws
/// std::runtime_error, which names the packages.
#pragma once
#include <csignal>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/view/live_simulation.hpp"
#include "host/view/screens/room.hpp"
#include "host/view/view_scene.hpp"
#include "host/view/window/volume_actors.hpp"

namespace tetwarp::view {

/// What the master's window shows, for its screens.
struct MasterView {
  Camera camera;
  VolumeLook volumes = VolumeLook::rays;
  bool shows_contacts = true;
  double level = 0, width = 1;  ///< as VolumeActors::set_window()
  SliceLook slices;
  std::optional<Cut> cut;
  std::vector<ColorPoint> curve;  ///< as VolumeActors::set_curve(); empty: nobody changed it
  std::vector<WandRay> rays;      ///< of wands
};

/// The master's end: serves all screens, and starts those of this machine.
class MasterScreens {
 public:
  /// @param simulation  that has not begun
  /// @throws IoError  the room or its keys
  MasterScreens(LiveSimulation& simulation, const ViewScene& scene, const ViewOptions& options);
  MasterScreens(const MasterScreens&) = delete;
  MasterScreens& operator=(const MasterScreens&) = delete;
  ~MasterScreens();  ///< ends the simulation, then the screens that it started

  /// Until the screens that it started take part, have ended, or too much time is over.
  void wait_for_screens();

  /// Never waits.
  void set_view(const MasterView& view);
  const Room& room() const;
  /// A line about the screens.
  std::string status() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Draws a screen until the master, a signal or the user ends it.
void show_screen(const ViewOptions& options, const volatile std::sig_atomic_t& is_interrupted);

/// Sends head poses of ViewOptions::tracker to a master, until they or a signal end it.
void send_head(const ViewOptions& options, const volatile std::sig_atomic_t& is_interrupted);

/// Writes NAME.key for a master and NAME_screen.key for its screens.
void write_screen_keys(const std::string& name);

}  // namespace tetwarp::view
