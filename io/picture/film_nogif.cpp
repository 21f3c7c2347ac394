/// @file film_nogif.cpp
/// In place of film_gif.cpp where giflib was missing when this was built.
#include <tetwarp/error.hpp>
#include <tetwarp/film.hpp>

namespace tetwarp {

struct FilmWriter::State {};

void FilmWriter::check_available(const std::string& path) {
  throw IoError(path, "",
                "this build cannot write films; install libgif-dev and build again, or make a film "
                "of the pictures that --picture writes");
}
FilmWriter::FilmWriter(const std::string& path) {
  check_available(path);
}
FilmWriter::FilmWriter(FilmWriter&&) noexcept = default;
FilmWriter::~FilmWriter() = default;
void FilmWriter::append(const Image&, double) {}
void FilmWriter::finish() {}

}  // namespace tetwarp
