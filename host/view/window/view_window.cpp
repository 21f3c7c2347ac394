/// @file view_window.cpp
/// Set-up, the loop of frames, keys and the mouse.
#include "host/view/window/view_window.hpp"

#include <fmt/format.h>
#include <vtkCallbackCommand.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string_view>
#include <tetwarp/io.hpp>
#include <thread>

#include "host/base/point3.hpp"
#include "host/view/devices/open_devices.hpp"
#include "host/view/overlay_text.hpp"
#include "host/view/window/window_camera.hpp"
#include "host/view/window/window_picture.hpp"

namespace tetwarp::view {
namespace {
constexpr unsigned long timer_interval = 15;  // [ms]
constexpr double resting_seconds = 0.4;       // until rays become finer
constexpr double cut_step = 0.02;             // of the size of the scene
constexpr double window_pixels = 400;         // by which the mouse moves the window by its width

/// Without screens the window is one, at 0.6 m from an observer at the origin.
RoomPlace room_place(const MasterScreens* screens, const Camera& camera) {
  Room own;
  own.focus = 0.6;
  return place_of_camera(screens != nullptr ? screens->room() : own, camera);
}
}  // namespace

ViewWindow::ViewWindow(const ViewScene& scene,
                       LiveSimulation& simulation,
                       const ViewOptions& options,
                       MasterScreens* screens)
    : scene_(scene),
      simulation_(simulation),
      options_(options),
      screens_(screens),
      quantity_(quantity_of(options.colors)),
      pictures_(simulation),
      hand_(scene, simulation, [this] { return cut_plane_.cut(); }) {
  set_up_window();
  set_up_mouse();
  if (!options_.devices.empty()) set_up_devices();
}

void ViewWindow::set_up_window() {
  renderer_->SetBackground(0.93, 0.94, 0.96);
  renderer_->SetBackground2(0.72, 0.77, 0.84);
  renderer_->GradientBackgroundOn();
  set_camera(scene_.camera, renderer_->GetActiveCamera());
  window_->SetMultiSamples(0);
  window_->SetSize(static_cast<int>(options_.width), static_cast<int>(options_.height));
  window_->SetWindowName("tetwarp");
  window_->AddRenderer(renderer_);
  events_->SetRenderWindow(window_);
}

void ViewWindow::set_up_mouse() {
  MouseActions actions;
  actions.grab = [this](int x, int y) { return may_grab_ && grab(x, y); };
  actions.pull = [this](int x, int y) { hand_.pull(pointer_.world_of(x, y, grab_depth_)); };
  actions.release = [this] { hand_.release(); };
  actions.turn_window = [this](int x, int y) { return turn_window(x, y); };
  actions.take_point = [this](int x, int y, bool tints) {
    return curve_ && curve_->press(x, y, tints);
  };
  actions.move_point = [this](int x, int y) {
    if (!curve_->move(x, y)) return;
    volumes_->set_curve(curve_->editor()->curve());
    draw();
  };
  actions.move_slice = [this](int x, int y, int steps) { return move_slice(x, y, steps); };
  actions.press = [this](const PressedKey& key) { press(key); };
  style_->set_actions(std::move(actions));
  events_->SetInteractorStyle(style_);
}

void ViewWindow::set_up_devices() {
  HandActions actions = hand_.actions();
  actions.grab = [this](const Pick& point) {
    style_->let_go();  // one thing is held at a time
    hand_.grab(point);
  };
  actions.probe = [this](const EyeRay& ray) {
    note(hand_.probe(ray));
    draw();
  };
  actions.place = [this](const Camera& camera) { return room_place(screens_, camera); };
  devices_.emplace(open_devices(options_.devices), std::move(actions));
}

/// @returns whether there is something new to draw
bool ViewWindow::update_devices() {
  if (!devices_) return false;
  Camera camera = camera_of(renderer_->GetActiveCamera());
  const int* const size = window_->GetSize();
  const EyeRay middle = pointer_.ray_at(size[0] / 2, size[1] / 2);
  const bool has_moved = devices_->update(camera, middle);
  if (has_moved) set_camera(camera, renderer_->GetActiveCamera());
  if (devices_->has_news()) actors_->show_rays(devices_->rays());
  return has_moved || devices_->has_news();
}

void ViewWindow::run(const volatile std::sig_atomic_t& is_interrupted) {
  is_interrupted_ = &is_interrupted;
  while (!simulation_.frames().take()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  LiveFrame& frame = simulation_.frames().front();
  if (frame.points.empty() && frame.has_failed) return;
  actors_.emplace(scene_, frame, renderer_);
  volumes_.emplace(scene_, options_.preset, renderer_);
  legend_.emplace(renderer_);
  if (!scene_.volumes.empty()) {
    curve_.emplace(renderer_);
    curve_->set_curve(volumes_->curve());
  }
  window_->Render();
  rays_ = RayQuality(is_software(window_));
  volumes_->set_rays(rays_.moving());
  set_up_drawing();
  set_look(VolumeLook::rays);
  actors_->show(frame);
  volumes_->show(frame);
  events_->Initialize();
  vtkNew<vtkCallbackCommand> tick;
  tick->SetClientData(this);
  tick->SetCallback([](vtkObject*, unsigned long, void* window, void*) {
    static_cast<ViewWindow*>(window)->on_timer();
  });
  events_->AddObserver(vtkCommand::TimerEvent, tick);
  events_->CreateRepeatingTimer(timer_interval);
  draw();
  tell_screens();
  window_->SetWindowName(("tetwarp: " + scene_.name).c_str());  // now it takes events
  if (!options_.film.empty()) film_.require(options_.film);
  pictures_.begin();
  events_->Start();
  pictures_.end();
  tell_screens();  // what the last events have changed
  attempt([this] { film_.end(); });
}

/// The screens follow the camera and what is shown.
void ViewWindow::tell_screens() {
  if (screens_ == nullptr) return;
  MasterView view;
  view.camera = camera_of(renderer_->GetActiveCamera());
  view.volumes = look_;
  view.slices = slices_;
  view.shows_contacts = shows_contacts_;
  view.level = level_;
  view.width = width_;
  view.cut = cut_plane_.cut();
  if (curve_) view.curve = curve_->editor()->edited();
  if (devices_) view.rays = devices_->rays();
  screens_->set_view(view);
}

void ViewWindow::on_timer() {
  const bool has_changed = update_devices();
  tell_screens();
  if (simulation_.frames().take()) {
    LiveFrame& frame = simulation_.frames().front();
    if (frame.points.size() == scene_.triangles.size()) {
      actors_->show(frame);
      volumes_->show(frame);
    }
    draw();
  } else if (has_changed) {
    draw();
  }
  if (resting_.seconds() > resting_seconds) refine();
  const LiveFrame& frame = simulation_.frames().front();
  const bool is_limited = options_.steps.has_value() || !options_.replay.empty();
  const bool is_over = (frame.is_last && !(devices_ && devices_->is_simulating())) ||
                       (frame.has_failed && is_limited);
  if (is_over || *is_interrupted_ != 0) events_->TerminateApp();
}

/// Pictures are timed whoever draws them; when the camera begins to move, rays become coarse.
void ViewWindow::set_up_drawing() {
  vtkNew<vtkCallbackCommand> begin, end, move;
  for (vtkCallbackCommand* const command : {begin.Get(), end.Get(), move.Get()}) {
    command->SetClientData(this);
  }
  begin->SetCallback([](vtkObject*, unsigned long, void* window, void*) {
    static_cast<ViewWindow*>(window)->drawing_ = Stopwatch();
  });
  end->SetCallback([](vtkObject*, unsigned long, void* window, void*) {
    auto* const self = static_cast<ViewWindow*>(window);
    self->note_picture(self->drawing_.seconds());
  });
  move->SetCallback([](vtkObject*, unsigned long, void* window, void*) {
    auto* const self = static_cast<ViewWindow*>(window);
    self->is_refined_ = false;
    self->volumes_->set_rays(self->rays_.moving());
  });
  window_->AddObserver(vtkCommand::StartEvent, begin);
  window_->AddObserver(vtkCommand::EndEvent, end);
  style_->AddObserver(vtkCommand::StartInteractionEvent, move);
}

void ViewWindow::note_picture(double seconds) {
  pictures_.drew();
  attempt([this] { film_.note(window_); });
  if (is_refined_) return;
  resting_ = Stopwatch();
  if (look_ != VolumeLook::rays || scene_.volumes.empty()) return;
  rays_.drew(seconds);
  volumes_->set_rays(rays_.moving());
  if (!rays_.gives_up()) return;
  set_look(VolumeLook::slices);
  note(fmt::format("slices, as rays take {:.1f} s a picture; v v: rays", seconds));
}

/// Once, when nothing has moved for a while.
void ViewWindow::refine() {
  if (is_refined_ || look_ != VolumeLook::rays || scene_.volumes.empty() ||
      rays_.resting() == rays_.moving())
    return;
  is_refined_ = true;
  volumes_->set_rays(rays_.resting());
  renderer_->ResetCameraClippingRange();
  window_->Render();
}

void ViewWindow::draw() {
  is_refined_ = false;
  volumes_->set_rays(rays_.moving());
  texts_.set(overlay());
  const LiveFrame& frame = simulation_.frames().front();
  legend_->show(frame.quantity, frame.range);
  if (curve_) curve_->update();
  renderer_->ResetCameraClippingRange();
  window_->Render();
  delay_.drawn(simulation_.frames().front().input);
}

void ViewWindow::note(const std::string& text) {
  note_ = text;
}

std::string ViewWindow::overlay() {
  std::string text = overlay_text(scene_, simulation_.frames().front(), pictures_.last_second());
  if (screens_ != nullptr) text += "\n" + screens_->status();
  if (film_.is_running()) text += "\nfilm " + film_.path();
  if (devices_ && !devices_->problems().empty()) text += "\n" + devices_->problems();
  if (!note_.empty()) text += "\n" + note_;
  return text;
}

/// Of the next quantity after the one that was asked for last, which no frame may have yet.
void ViewWindow::color_surfaces() {
  constexpr int quantities = static_cast<int>(SurfaceQuantity::adhesion) + 1;
  quantity_ = static_cast<SurfaceQuantity>((static_cast<int>(quantity_) + 1) % quantities);
  simulation_.give({.kind = OrderKind::values, .quantity = quantity_});
}

void ViewWindow::turn_film() {
  const std::string path = film_.path();
  attempt([&] {
    if (path.empty()) return film_.begin(free_name(".gif"));
    film_.end();
    note("wrote " + path);
  });
}

/// The window goes on where it fails.
void ViewWindow::attempt(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::exception& error) {
    note(error.what());
  }
}

void ViewWindow::set_look(VolumeLook look) {
  look_ = look;
  rays_.try_again();
  volumes_->set_look(look);
  for (const VolumeBody& volume : scene_.volumes) {
    actors_->show_body(volume.body, look == VolumeLook::surfaces);
  }
  simulation_.give({.kind = look == VolumeLook::surfaces || scene_.volumes.empty()
                                ? OrderKind::volumes_off
                                : OrderKind::volumes_on});
}

void ViewWindow::press(const PressedKey& key) {
  note_.clear();
  vtkCamera* const camera = renderer_->GetActiveCamera();
  const bool is_closing = key.name == "q" && key.has_control;
  if (is_closing || (key.name == "Escape" && !let_go())) return events_->TerminateApp();
  if (const auto moved = camera_after(key, camera_of(camera), scene_.camera)) {
    set_camera(*moved, camera);
  } else if (!key.has_control) {
    act(key.name);
  }
  draw();
}

void ViewWindow::act(const std::string& key) {
  if (key == "space") simulation_.give({.kind = OrderKind::pause});
  if (key == "period") simulation_.give({.kind = OrderKind::step});
  if (key == "BackSpace") simulation_.give({.kind = OrderKind::restart});
  if (key == "g") turn_grabbing();
  if (key == "i") note(hand_.probe(pointer_.ray_at(events_->GetEventPosition())));
  if (key == "x") cut_plane_.turn(scene_.center, renderer_);
  if (key == "Next") cut_plane_.move(cut_step * scene_.size, renderer_);
  if (key == "Prior") cut_plane_.move(-cut_step * scene_.size, renderer_);
  if (key == "c") actors_->show_contacts(shows_contacts_ = !shows_contacts_);
  if (key == "v") {
    set_look(look_ == VolumeLook::rays     ? VolumeLook::slices
             : look_ == VolumeLook::slices ? VolumeLook::surfaces
                                           : VolumeLook::rays);
  }
  if (key == "n") {
    choose_next(slices_);
    volumes_->set_slices(slices_);
  }
  if (key == "h") texts_.turn_help();
  if (key == "k") color_surfaces();
  if (key == "m") turn_film();
  if (key == "o" && curve_) curve_->turn();
  if (key == "F11") full_screen_.turn();
  if (key == "F12") save_next_picture();
}

void ViewWindow::save_next_picture() {
  attempt([this, path = free_name(".png")] {
    save_picture(path);
    note("wrote " + path);
  });
}

/// @returns whether mouse or devices held anything
bool ViewWindow::let_go() {
  const bool by_mouse = style_->let_go();
  const bool by_device = devices_ && devices_->let_go();
  return by_mouse || by_device;
}

void ViewWindow::turn_grabbing() {
  may_grab_ = !may_grab_;
  note(may_grab_ ? "left pulls bodies" : "left turns the camera, also on bodies; g: pulls");
}

bool ViewWindow::move_slice(int x, int y, int steps) {
  if (look_ != VolumeLook::slices) return false;
  const EyeRay ray = pointer_.ray_at(x, y);
  std::optional<MetSlice> first;
  for (const VolumeFrame& volume : simulation_.frames().front().volumes) {
    const auto met = slice_at(volume.grid, slices_, ray.origin, ray.direction);
    if (met && (!first || met->distance < first->distance)) first = met;
  }
  if (!first) return true;
  view::move_slice(slices_, first->axis, steps);
  volumes_->set_slices(slices_);
  draw();
  return true;
}

bool ViewWindow::grab(int x, int y) {
  const auto found = hand_.meet(pointer_.ray_at(x, y));
  if (!found) return false;
  if (devices_) devices_->let_go();
  grab_depth_ = pointer_.depth_of(found->point);
  hand_.grab(*found);
  return true;
}

bool ViewWindow::turn_window(int x, int y) {
  if (scene_.volumes.empty() || look_ == VolumeLook::surfaces) return false;
  if (x == 0 && y == 0) return true;
  width_ = std::clamp(width_ * std::exp2(x / window_pixels), 0.01, 100.0);
  level_ -= y / window_pixels;
  volumes_->set_window(level_, width_);
  draw();
  return true;
}

void ViewWindow::save_picture(const std::string& path) {
  is_refined_ = true;
  volumes_->set_rays({});
  const Image picture = picture_of(window_);
  write_png(path, picture);
}

std::string ViewWindow::failure() {
  const LiveFrame& frame = simulation_.frames().front();
  return frame.has_failed ? frame.message : std::string();
}

}  // namespace tetwarp::view
