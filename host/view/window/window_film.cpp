/// @file window_film.cpp
/// Pictures of a window and how long they were seen.
#include "host/view/window/window_film.hpp"

#include <fmt/format.h>

#include <exception>
#include <tetwarp/io.hpp>
#include <utility>

#include "host/view/window/window_picture.hpp"

namespace tetwarp::view {
namespace {
constexpr double least_seconds = 0.1;  // from one picture to the next
}  // namespace

void WindowFilm::begin(const std::string& path) {
  if (path.ends_with(".gif")) gif_.emplace(path);
  path_ = path;
  count_ = 0;
}

void WindowFilm::require(const std::string& path) {
  begin(path);
  is_required_ = true;
}

void WindowFilm::note(vtkRenderWindow* window) {
  if (!is_running() || (last_ && seen_.seconds() < least_seconds)) return;
  Image image = drawn_picture_of(window);
  if (last_ && (image.width != last_->width || image.height != last_->height)) return;
  attempt([this] {
    if (last_) write(*last_, seen_.seconds());
  });
  last_ = std::move(image);
  seen_ = {};
}

void WindowFilm::end() {
  if (!is_running()) return;
  attempt([this] {
    if (last_) write(*last_, seen_.seconds());
    if (gif_) gif_->finish();
  });
  drop();
}

void WindowFilm::write(const Image& image, double seconds) {
  if (gif_) return gif_->append(image, seconds);
  const std::string stem = path_.substr(0, path_.rfind('.'));
  write_png(fmt::format("{}_{:04}.png", stem, count_++), image);
}

/// A film ends where it fails.
void WindowFilm::attempt(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::exception& error) {
    if (is_required_) failure_ = error.what();
    drop();
    throw;
  }
}

void WindowFilm::drop() {
  path_.clear();
  is_required_ = false;
  gif_.reset();
  last_.reset();
}

}  // namespace tetwarp::view
