/// @file window_film.hpp
/// WindowFilm: a film of what a window shows.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include <vtkRenderWindow.h>
#include <tetwarp/film.hpp>
#include <tetwarp/make.hpp>

#include "host/base/stopwatch.hpp"

namespace tetwarp::view {

/// At most ten pictures a second, each shown for as long as it was seen: an animated GIF, or PNGs
/// with numbers. Errors of files are IoError, and end the film.
class WindowFilm {
 public:
  /// @param path  NAME.gif; or NAME.png for NAME_0000.png and so on
  void begin(const std::string& path);
  /// As begin(), of a film that is needed: failure() keeps why it is not complete.
  void require(const std::string& path);
  const std::string& failure() const { return failure_; }
  bool is_running() const { return !path_.empty(); }
  /// Of the film that runs.
  const std::string& path() const { return path_; }
  /// The window has drawn a picture. Pictures of another size than the first are left out.
  void note(vtkRenderWindow* window);
  /// Completes the file of the film that runs.
  void end();

 private:
  void write(const Image& image, double seconds);
  void attempt(const std::function<void()>& action);
  void drop();

  std::string path_, failure_;
  bool is_required_ = false;
  std::optional<FilmWriter> gif_;
  std::optional<Image> last_;  ///< not written yet: how long it is seen is not known
  Stopwatch seen_;             ///< since then
  std::int64_t count_ = 0;     ///< of PNGs
};

}  // namespace tetwarp::view
