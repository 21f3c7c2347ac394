/// @file film.hpp
/// Films of pictures: animated GIF.
#pragma once
#include <memory>
#include <string>

#include <tetwarp/io_export.hpp>
#include <tetwarp/make.hpp>

namespace tetwarp {

/// Writes an animated GIF picture by picture; it plays in a loop. Each picture has a palette of its
/// own, of at most 256 colors, and stores the part that differs from the picture before. The file
/// gets its name when it is complete.
class TETWARP_IO_EXPORT FilmWriter {
 public:
  /// @throws IoError  when this build lacks the library giflib; the text names `path`
  static void check_available(const std::string& path);

  /// @throws IoError  when the file cannot be created, or as check_available()
  explicit FilmWriter(const std::string& path);
  FilmWriter(FilmWriter&&) noexcept;
  ~FilmWriter();  ///< without finish(): removes the temporary file

  /// Appends a picture, of the same size as the others.
  /// @param seconds  for which it is shown, rounded to 1/100 s so that the sum of all stays exact;
  ///                 at least 0.02 s, below which browsers show pictures for 0.1 s
  void append(const Image& image, double seconds);

  /// Flushes and moves the file to its name. Throws IoError, also when there is no picture.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tetwarp
