/// @file view_window.cpp
/// Set-up, the loop of frames, keys and the mouse.
#include "host/view/window/view_window.hpp"

#include <fmt/format.h>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string_view>
#include <tetwarp/io.hpp>
#include <thread>

#include "host/base/point3.hpp"
#include "host/view/window/overlay_text.hpp"
#include "host/view/window/window_picture.hpp"

namespace tetwarp::view {
namespace {
constexpr unsigned long timer_interval = 15;  // [ms]
// Ray casting is given up after so many pictures one after the other that took longer than this.
constexpr double slow_seconds = 1.0;
constexpr int most_slow_frames = 5;
constexpr double resting_seconds = 0.4;  // until rays become finer
constexpr double cut_step = 0.02;        // of the size of the scene
constexpr double window_pixels = 400;    // by which the mouse moves the window by its width

/// The next number that no file in the working folder has.
std::string free_name(const std::string& ending) {
  std::string path;
  int number = 0;
  do {
    path = fmt::format("view_{:04}{}", number++, ending);
  } while (std::filesystem::exists(path));
  return path;
}
}  // namespace

ViewWindow::ViewWindow(const ViewScene& scene,
                       LiveSimulation& simulation,
                       const ViewOptions& options,
                       MasterScreens* screens)
    : scene_(scene), simulation_(simulation), options_(options), screens_(screens) {
  set_up_window();
  set_up_mouse();
  if (!options_.devices.empty()) set_up_devices();
}

void ViewWindow::set_up_window() {
  renderer_->SetBackground(0.93, 0.94, 0.96);
  renderer_->SetBackground2(0.72, 0.77, 0.84);
  renderer_->GradientBackgroundOn();
  vtkCamera* const camera = renderer_->GetActiveCamera();
  camera->SetPosition(scene_.camera.eye.data());
  camera->SetFocalPoint(scene_.camera.target.data());
  camera->SetViewUp(scene_.camera.up.data());
  camera->SetViewAngle(scene_.camera.angle * 180 / std::numbers::pi);
  window_->SetMultiSamples(0);
  window_->SetSize(static_cast<int>(options_.width), static_cast<int>(options_.height));
  window_->SetWindowName("tetwarp");
  window_->AddRenderer(renderer_);
  events_->SetRenderWindow(window_);
}

void ViewWindow::set_up_mouse() {
  MouseActions actions;
  actions.grab = [this](int x, int y) { return grab(x, y); };
  actions.pull = [this](int x, int y) { pull(x, y); };
  actions.release = [this] { simulation_.give({.kind = OrderKind::release}); };
  actions.turn_window = [this](int x, int y) { return turn_window(x, y); };
  actions.take_point = [this](int x, int y, bool tints) {
    return curve_ && curve_->press(x, y, tints);
  };
  actions.move_point = [this](int x, int y) {
    if (!curve_->move(x, y)) return;
    volumes_->set_curve(curve_->editor()->curve());
    draw();
  };
  actions.press = [this](const std::string& key) { press(key); };
  style_->set_actions(std::move(actions));
  events_->SetInteractorStyle(style_);
}

void ViewWindow::set_up_devices() {
  HandActions actions;
  actions.grab = [this](Point3& point) {
    const int* const size = window_->GetSize();
    if (!grab(size[0] / 2, size[1] / 2)) return false;
    point = world_of(size[0] / 2.0, size[1] / 2.0, grab_depth_);
    return true;
  };
  actions.pull = [this](const Point3& target) {
    simulation_.give({.kind = OrderKind::pull, .point = target});
  };
  actions.release = [this] { simulation_.give({.kind = OrderKind::release}); };
  devices_.emplace(options_.devices, std::move(actions));
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
  events_->Start();
  tell_screens();  // what the last events have changed
  attempt([this] { film_.end(); });
}

/// The screens follow the camera and what is shown.
void ViewWindow::tell_screens() {
  if (screens_ == nullptr) return;
  vtkCamera* const camera = renderer_->GetActiveCamera();
  MasterView view;
  camera->GetPosition(view.camera.eye.data());
  camera->GetFocalPoint(view.camera.target.data());
  camera->GetViewUp(view.camera.up.data());
  view.volumes = look_;
  view.shows_contacts = shows_contacts_;
  view.level = level_;
  view.width = width_;
  view.cut = cut_;
  if (curve_) view.curve = curve_->editor()->edited();
  screens_->set_view(view);
}

void ViewWindow::on_timer() {
  const bool has_moved = devices_ && devices_->update(renderer_->GetActiveCamera());
  tell_screens();
  if (simulation_.frames().take()) {
    LiveFrame& frame = simulation_.frames().front();
    if (frame.points.size() == scene_.triangles.size()) {
      actors_->show(frame);
      volumes_->show(frame);
    }
    draw();
  } else if (has_moved) {
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
  std::erase_if(drawn_, [](const Stopwatch& since) { return since.seconds() > 1; });
  drawn_.emplace_back();
  ++picture_count_;
  attempt([this] { film_.note(window_); });
  if (is_refined_) return;
  resting_ = Stopwatch();
  if (look_ != VolumeLook::rays || scene_.volumes.empty()) return;
  rays_.drew(seconds);
  volumes_->set_rays(rays_.moving());
  fall_back(seconds);
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
  legend_->show(simulation_.frames().front().quantity, actors_->range());
  if (curve_) curve_->update();
  renderer_->ResetCameraClippingRange();
  window_->Render();
  delay_.drawn(simulation_.frames().front().input);
}

/// Shows slices where rays take too long.
void ViewWindow::fall_back(double seconds) {
  slow_frames_ = seconds > slow_seconds ? slow_frames_ + 1 : 0;
  if (slow_frames_ < most_slow_frames) return;
  set_look(VolumeLook::slices);
  note(fmt::format("slices, as rays take {:.1f} s a picture; v v: rays", seconds));
}

void ViewWindow::note(const std::string& text) {
  note_ = text;
}

std::string ViewWindow::overlay() {
  std::string text = overlay_text(scene_, simulation_.frames().front(), drawn_.size());
  if (screens_ != nullptr) text += "\n" + screens_->status();
  if (film_.is_running()) text += "\nfilm " + film_.path();
  if (!note_.empty()) text += "\n" + note_;
  return text;
}

/// Of the next quantity.
void ViewWindow::color_surfaces() {
  constexpr int quantities = static_cast<int>(SurfaceQuantity::adhesion) + 1;
  const int now = static_cast<int>(simulation_.frames().front().quantity);
  const auto next = static_cast<SurfaceQuantity>((now + 1) % quantities);
  simulation_.give({.kind = OrderKind::values, .quantity = next});
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
  slow_frames_ = 0;
  volumes_->set_look(look);
  for (const VolumeBody& volume : scene_.volumes) {
    actors_->show_body(volume.body, look == VolumeLook::surfaces);
  }
  simulation_.give({.kind = look == VolumeLook::surfaces || scene_.volumes.empty()
                                ? OrderKind::volumes_off
                                : OrderKind::volumes_on});
}

void ViewWindow::press(const std::string& key) {
  note_.clear();
  if (key == "space") simulation_.give({.kind = OrderKind::pause});
  if (key == "s") simulation_.give({.kind = OrderKind::step});
  if (key == "r") simulation_.give({.kind = OrderKind::restart});
  if (key == "i") probe();
  if (key == "x") turn_cut();
  if (key == "comma" || key == "period") move_cut(key == "comma" ? cut_step : -cut_step);
  if (key == "c") actors_->show_contacts(shows_contacts_ = !shows_contacts_);
  if (key == "v") {
    set_look(look_ == VolumeLook::rays     ? VolumeLook::slices
             : look_ == VolumeLook::slices ? VolumeLook::surfaces
                                           : VolumeLook::rays);
  }
  if (key == "h") texts_.turn_help();
  if (key == "k") color_surfaces();
  if (key == "m") turn_film();
  if (key == "o" && curve_) curve_->turn();
  if (key == "p") {
    attempt([this, path = free_name(".png")] {
      save_picture(path);
      note("wrote " + path);
    });
  }
  if (key == "q" || key == "Escape") return events_->TerminateApp();
  draw();
}

Point3 ViewWindow::world_of(double x, double y, double depth) {
  renderer_->SetDisplayPoint(x, y, depth);
  renderer_->DisplayToWorld();
  const double* const world = renderer_->GetWorldPoint();
  return {world[0] / world[3], world[1] / world[3], world[2] / world[3]};
}

/// @param ray  out, from the eye
std::optional<Pick> ViewWindow::pick_at(int x, int y, Point3& ray) {
  const Point3 near = world_of(x, y, 0);
  ray = minus(world_of(x, y, 1), near);
  return pick(simulation_.frames().front().points, scene_.triangles, near, ray, cut_);
}

/// Notes what is under the pointer.
void ViewWindow::probe() {
  const int* const place = events_->GetEventPosition();
  Point3 ray{};
  const auto found = pick_at(place[0], place[1], ray);
  if (!found) return note("nothing is there");
  note(probe_text(scene_, simulation_.frames().front(), *found, ray));
}

/// Hides what is before the middle of the scene, or shows all again.
void ViewWindow::turn_cut() {
  if (cut_) {
    cut_.reset();
  } else {
    Point3 away{};
    renderer_->GetActiveCamera()->GetViewPlaneNormal(away.data());
    cut_ = Cut{scene_.center, unit(away)};
  }
  cut_plane_.set(cut_, renderer_);
}

void ViewWindow::move_cut(double share) {
  if (!cut_) return;
  cut_->point = plus(cut_->point, times(share * scene_.size, cut_->normal));
  cut_plane_.set(cut_, renderer_);
}

bool ViewWindow::grab(int x, int y) {
  Point3 ray{};
  const auto found = pick_at(x, y, ray);
  if (!found) return false;
  renderer_->SetWorldPoint(found->point[0], found->point[1], found->point[2], 1);
  renderer_->WorldToDisplay();
  grab_depth_ = renderer_->GetDisplayPoint()[2];
  simulation_.give({.kind = OrderKind::grab, .body = found->body, .point = found->point});
  return true;
}

void ViewWindow::pull(int x, int y) {
  simulation_.give({.kind = OrderKind::pull, .point = world_of(x, y, grab_depth_)});
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
