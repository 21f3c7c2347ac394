/// @file screen_window.cpp
/// The loop of a screen, and the camera of each eye.
#include "host/view/window/screen_window.hpp"

#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkMatrix4x4.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tetwarp/io.hpp>
#include <tetwarp/names.hpp>

#include "host/base/point3.hpp"
#include "host/view/screens/off_axis.hpp"
#include "host/view/window/window_picture.hpp"

namespace tetwarp::view {
namespace {
constexpr double poll_seconds = 0.02, join_seconds = 1;
constexpr double clip_margin = 1.05, nearest_share = 1e-4;
constexpr int usual_width = 640, usual_height = 480;  // [pixel]

Backend backend_of(const ViewOptions& options) {
  return parse<Backend>(options.backend);
}

/// Distances of what a renderer shows from an eye, against a direction.
std::array<double, 2> depths(vtkRenderer* renderer, const Point3& eye, const Point3& back) {
  double box[6];
  renderer->ComputeVisiblePropBounds(box);
  double nearest = INFINITY, farthest = 0;
  if (box[0] <= box[1]) {
    for (std::size_t c = 0; c < 8; ++c) {
      const Point3 corner{box[c & 1], box[2 + (c >> 1 & 1)], box[4 + (c >> 2 & 1)]};
      const double depth = dot(minus(eye, corner), back);
      nearest = std::min(nearest, depth);
      farthest = std::max(farthest, depth);
    }
  }
  if (!(farthest > 0)) return {0.1, 1};  // all is behind the eye
  farthest *= clip_margin;
  return {std::max(nearest / clip_margin, nearest_share * farthest), farthest};
}
}  // namespace

ScreenWindow::ScreenWindow(const ViewOptions& options, const ScreenKeys& keys)
    : options_(options), link_(options.join, keys) {
  renderer_->SetBackground(0.86, 0.88, 0.91);
  renderer_->AutomaticLightCreationOff();
  light_->SetLightTypeToSceneLight();
  light_->PositionalOff();
  renderer_->AddLight(light_);
  window_->SetMultiSamples(0);
  window_->AddRenderer(renderer_);
  events_->SetRenderWindow(window_);
  events_->SetInteractorStyle(nullptr);
  events_->EnableRenderOff();
  renderer_->GetActiveCamera()->SetEyeAngle(0);
  vtkNew<vtkCallbackCommand> eye, key;
  eye->SetClientData(this);
  eye->SetCallback([](vtkObject*, unsigned long, void* window, void*) {
    static_cast<ScreenWindow*>(window)->set_eye();
  });
  renderer_->AddObserver(vtkCommand::StartEvent, eye);
  key->SetClientData(this);
  key->SetCallback([](vtkObject*, unsigned long, void* window, void*) {
    auto* const self = static_cast<ScreenWindow*>(window);
    const std::string name = self->events_->GetKeySym() ? self->events_->GetKeySym() : "";
    const bool is_closing = name == "q" && self->events_->GetControlKey() != 0;
    if (is_closing || name == "Escape") self->is_over_ = true;
  });
  events_->AddObserver(vtkCommand::KeyPressEvent, key);
}

void ScreenWindow::run(const volatile std::sig_atomic_t& is_interrupted) {
  Stopwatch since_heard;
  join();
  while (!is_over_ && is_interrupted == 0) {
    if (std::optional<ToScreen> message = link_.receive(poll_seconds)) {
      since_heard = Stopwatch();
      receive(std::move(*message));
    }
    if (since_heard.seconds() > join_seconds) {  // no master, or one that knows nothing of us
      since_heard = Stopwatch();
      join();
    }
    if (is_open_) {
      events_->ProcessEvents();
      is_over_ = is_over_ || events_->GetDone();
    }
  }
  link_.send(LeaveMessage{});
  if (!options_.screenshot.empty() && actors_) {
    volumes_->set_rays({});
    write_png(options_.screenshot, picture_of(window_));
  }
}

void ScreenWindow::join() {
  link_.send(JoinMessage{options_.screen, session_});
}

void ScreenWindow::receive(ToScreen message) {
  if (auto* const welcomed = std::get_if<WelcomeMessage>(&message)) {
    welcome(std::move(*welcomed));
  } else if (const auto* const refused = std::get_if<RefuseMessage>(&message)) {
    throw std::runtime_error("screen " + options_.screen + ": " + refused->reason);
  } else if (const auto* const frame = std::get_if<FrameMessage>(&message)) {
    if (frame->session == session_ && session_ != 0) draw(*frame);
  } else if (const auto* const shown = std::get_if<SwapMessage>(&message)) {
    if (shown->frame != drawn_) return;
    window_->SwapBuffersOn();
    window_->Frame();
    drawn_ = 0;
    if (!has_shown_) window_->SetWindowName(("tetwarp screen: " + screen_.name).c_str());
    has_shown_ = true;
  } else if (std::holds_alternative<WhoMessage>(message)) {
    join();
  } else if (options_.ends_with_master) {
    is_over_ = true;
  }
}

void ScreenWindow::welcome(WelcomeMessage message) {
  const bool is_new = !message.scene.empty();
  if (!is_new && message.session != session_) return;
  if (is_new) load(scene_of(message.scene));
  session_ = message.session;
  if (!is_open_) set_up_window(message.screen);
  screen_ = std::move(message.screen);
}

void ScreenWindow::set_up_window(const Screen& screen) {
  const auto& [left, top, width, height] = screen.window;
  window_->SetSize(width > 0 ? width : usual_width, height > 0 ? height : usual_height);
  window_->SetPosition(left, top);
  window_->SetBorders(screen.has_border);
  window_->SetFullScreen(screen.is_fullscreen);
  if (screen.stereo == Stereo::side_by_side) window_->SetStereoTypeToSplitViewportHorizontal();
  if (screen.stereo == Stereo::anaglyph) window_->SetStereoTypeToAnaglyph();
  if (screen.stereo == Stereo::quad_buffer) {
    window_->StereoCapableWindowOn();
    window_->SetStereoTypeToCrystalEyes();
  }
  const bool has_both = screen.stereo != Stereo::none && screen.stereo != Stereo::left &&
                        screen.stereo != Stereo::right;
  window_->SetStereoRender(has_both);
  window_->SetWindowName("tetwarp");
  window_->SwapBuffersOff();
  window_->Render();
  if (screen.stereo == Stereo::quad_buffer && window_->GetStereoCapableWindow() == 0) {
    throw std::runtime_error("screen " + screen.name +
                             ": this display has no stereo of two buffers; use side_by_side or "
                             "anaglyph");
  }
  rays_ = RayQuality(is_software(window_));
  events_->Initialize();
  is_open_ = true;
}

/// Nothing of an earlier scene stays.
void ScreenWindow::load(SharedScene scene) {
  actors_.reset();
  volumes_.reset();
  renderer_->RemoveAllViewProps();
  state_bytes_.clear();
  shared_ = std::move(scene);
  scene_ = ViewScene{};
  scene_.name = shared_.name;
  scene_.obstacles = shared_.obstacles;
  scene_.center = shared_.center;
  scene_.size = shared_.size;
  for (const SharedBody& body : shared_.bodies) scene_.triangles.push_back(body.triangles);
  std::vector<RestVolume> sources;
  for (const SharedVolume& volume : shared_.volumes) {
    scene_.volumes.push_back(volume.source.body);
    sources.push_back(volume.source);
  }
  ViewOptions options = options_;
  options.voxels = shared_.voxels;
  warps_.emplace(std::move(sources), options, backend_of(options_));
}

void ScreenWindow::draw(const FrameMessage& message) {
  try {
    show_state(message);
  } catch (const std::invalid_argument&) {  // a damaged state: the picture stays
    link_.send(ReadyMessage{message.frame});
    return;
  }
  eyes_ = eyes_of(message.head, message.eye_separation);
  if (screen_.stereo == Stereo::none) eyes_ = {message.head.position, message.head.position};
  if (screen_.stereo == Stereo::left) eyes_[1] = eyes_[0];
  if (screen_.stereo == Stereo::right) eyes_[0] = eyes_[1];
  place_ = message.place;
  set_light(place_);
  volumes_->set_rays(rays_.moving());
  window_->SwapBuffersOff();
  const Stopwatch watch;
  window_->Render();
  window_->WaitForCompletion();
  rays_.drew(watch.seconds());
  drawn_ = message.frame;
  link_.send(ReadyMessage{message.frame});
}

/// Moves bodies and warps volumes, unless the state is the one that is drawn. Volumes are not
/// warped while surfaces are shown; when the look changes, they are missing for the same state.
void ScreenWindow::show_state(const FrameMessage& message) {
  const auto look = static_cast<VolumeLook>(message.look.volumes);
  const bool needs_volumes =
      look != VolumeLook::surfaces && !scene_.volumes.empty() && frame_.volumes.empty();
  const bool is_new = message.state != state_bytes_ || needs_volumes;
  if (is_new) {
    const SharedState state = state_of(message.state, shared_);
    set_frame(shared_, state, frame_);
    if (look == VolumeLook::surfaces) {
      frame_.volumes.clear();
    } else {
      warps_->warp(
          [&](std::size_t volume) {
            VolumeNodes nodes;
            nodes.mesh = &shared_.volumes[volume].mesh;
            nodes.places = nodes_of(state, shared_.volumes[volume].source.body.body);
            nodes.view = PositionsView(nodes.places);
            return nodes;
          },
          frame_.volumes);
    }
  }
  if (!actors_) {
    actors_.emplace(scene_, frame_, renderer_);
    volumes_.emplace(scene_, shared_.preset, renderer_);
  }
  if (is_new) {
    actors_->show(frame_);
    volumes_->show(frame_);
    state_bytes_ = message.state;
  }
  actors_->show_contacts(message.look.shows_contacts);
  actors_->show_rays(message.look.rays);
  for (const VolumeBody& volume : scene_.volumes) {
    actors_->show_body(volume.body, look == VolumeLook::surfaces);
  }
  volumes_->set_look(look);
  if (!message.look.curve.empty()) volumes_->set_curve(message.look.curve);
  volumes_->set_window(message.look.level, message.look.width);
  volumes_->set_slices(message.look.slices);
  cut_.set(message.look.cut, renderer_);
}

/// The same light on all screens, from where the master's camera is.
void ScreenWindow::set_light(const RoomPlace& place) {
  const Point3 from = plus(place.origin, place.axes[2]);
  light_->SetPosition(from.data());
  light_->SetFocalPoint(place.origin.data());
}

/// Before each eye is drawn.
void ScreenWindow::set_eye() {
  vtkCamera* const camera = renderer_->GetActiveCamera();
  const bool is_left = camera->GetLeftEye() != 0;
  Screen in_world = screen_;
  in_world.lower_left = place_.world_of(screen_.lower_left);
  in_world.lower_right = place_.world_of(screen_.lower_right);
  in_world.upper_right = place_.world_of(screen_.upper_right);
  const auto view = off_axis_view(in_world, place_.world_of(eyes_[is_left ? 0 : 1]));
  if (!view) return;  // the head is behind the screen: the view stays
  const Point3 back = unit(minus(view->eye, view->target));
  const auto [nearest, farthest] = depths(renderer_, view->eye, back);
  camera->SetPosition(view->eye.data());
  camera->SetFocalPoint(view->target.data());
  camera->SetViewUp(view->up.data());
  camera->SetClippingRange(nearest, farthest);
  vtkNew<vtkMatrix4x4> matrix;
  const std::array<double, 16> rows = projection_of(*view, nearest, farthest);
  matrix->DeepCopy(rows.data());
  camera->SetExplicitProjectionTransformMatrix(matrix);
  camera->UseExplicitProjectionTransformMatrixOn();
}

}  // namespace tetwarp::view
