/// @file film_gif.cpp
/// Films as GIF: each picture is written as far as it differs from the one before.
#include <gif_lib.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <tetwarp/error.hpp>
#include <tetwarp/film.hpp>
#include <utility>

#include "io/files/finished_file.hpp"
#include "io/picture/palette.hpp"

namespace tetwarp {
namespace {
/// The part of a picture that differs from another of the same size; one pixel where none does.
PictureBox changed_part(const Image& image, const Image& before) {
  int low[2] = {image.width, image.height}, high[2] = {-1, -1};
  for (int y = 0; y < image.height; ++y) {
    const auto row = 3 * static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width);
    for (int x = 0; x < image.width; ++x) {
      const std::size_t at = row + 3 * static_cast<std::size_t>(x);
      if (std::memcmp(&image.rgb[at], &before.rgb[at], 3) == 0) continue;
      low[0] = std::min(low[0], x);
      high[0] = std::max(high[0], x);
      low[1] = std::min(low[1], y);
      high[1] = std::max(high[1], y);
    }
  }
  if (high[0] < 0) return {0, 0, 1, 1};
  return {low[0], low[1], high[0] - low[0] + 1, high[1] - low[1] + 1};
}

struct FreeColors {
  void operator()(ColorMapObject* colors) const { GifFreeMapObject(colors); }
};
using Colors = std::unique_ptr<ColorMapObject, FreeColors>;

/// A GIF's color table has a power of two of entries, two at least.
Colors colors_of(const std::vector<Color>& palette) {
  int size = 2;
  while (size < std::ssize(palette)) size *= 2;
  Colors colors(GifMakeMapObject(size, nullptr));
  if (!colors) throw std::bad_alloc();
  for (std::size_t c = 0; c < palette.size(); ++c) {
    colors->Colors[c] = {palette[c][0], palette[c][1], palette[c][2]};
  }
  return colors;
}
}  // namespace

struct FilmWriter::State {
  explicit State(const std::string& path) : file(path) {
    int error = 0;
    gif = EGifOpenFileName(file.temporary().c_str(), false, &error);
    if (gif == nullptr) fail(error);
  }
  ~State() {
    if (gif != nullptr) EGifCloseFile(gif, nullptr);
  }

  [[noreturn]] void fail(int error) const {
    const char* reason = GifErrorString(error);
    throw IoError(file.path(), "",
                  std::string("cannot be written: ") + (reason == nullptr ? "" : reason));
  }
  void check(int result) const {
    if (result == GIF_ERROR) fail(gif->Error);
  }

  void begin(const Image& image) {
    EGifSetGifVersion(gif, true);
    check(EGifPutScreenDesc(gif, image.width, image.height, 8, 0, nullptr));
    constexpr unsigned char loops_for_ever[] = {1, 0, 0};
    check(EGifPutExtensionLeader(gif, APPLICATION_EXT_FUNC_CODE));
    check(EGifPutExtensionBlock(gif, 11, "NETSCAPE2.0"));
    check(EGifPutExtensionBlock(gif, sizeof loops_for_ever, loops_for_ever));
    check(EGifPutExtensionTrailer(gif));
  }

  void put_delay(double seconds) {
    const double hundredths = std::clamp(100 * seconds + owed, 2.0, 65535.0);
    const int delay = static_cast<int>(std::lround(hundredths));
    owed = hundredths - delay;
    const GraphicsControlBlock control{DISPOSE_DO_NOT, false, delay, NO_TRANSPARENT_COLOR};
    unsigned char bytes[4];
    check(EGifPutExtension(gif, GRAPHICS_EXT_FUNC_CODE,
                           static_cast<int>(EGifGCBToExtension(&control, bytes)), bytes));
  }

  FinishedFile file;
  GifFileType* gif = nullptr;
  Image last;
  double owed = 0;  ///< 1/100 s by which the delays so far are too short
};

void FilmWriter::check_available(const std::string&) {}

FilmWriter::FilmWriter(const std::string& path) : state_(std::make_unique<State>(path)) {}
FilmWriter::FilmWriter(FilmWriter&&) noexcept = default;
FilmWriter::~FilmWriter() = default;

void FilmWriter::append(const Image& image, double seconds) {
  State& state = *state_;
  const bool is_first = state.last.rgb.empty();
  const bool is_sized = image.width > 0 && image.height > 0 && image.width <= 65535 &&
                        image.height <= 65535 &&
                        image.rgb.size() == 3 * static_cast<std::size_t>(image.width) *
                                                static_cast<std::size_t>(image.height);
  if (!is_sized ||
      (!is_first && (image.width != state.last.width || image.height != state.last.height))) {
    throw IoError(state.file.path(), "", "a picture has another size than its samples or the film");
  }
  if (is_first) state.begin(image);
  const PictureBox box =
      is_first ? PictureBox{0, 0, image.width, image.height} : changed_part(image, state.last);
  IndexedPicture part = index_picture(image, box);
  const Colors colors = colors_of(part.palette);
  state.put_delay(seconds);
  state.check(
      EGifPutImageDesc(state.gif, box.left, box.top, box.width, box.height, false, colors.get()));
  for (int y = 0; y < box.height; ++y) {
    state.check(EGifPutLine(
        state.gif, part.indices.data() + static_cast<std::ptrdiff_t>(y) * box.width, box.width));
  }
  state.last = image;
}

void FilmWriter::finish() {
  State& state = *state_;
  if (state.last.rgb.empty()) throw IoError(state.file.path(), "", "has no picture");
  int error = 0;
  if (EGifCloseFile(std::exchange(state.gif, nullptr), &error) == GIF_ERROR) state.fail(error);
  state.file.finish();
}

}  // namespace tetwarp
