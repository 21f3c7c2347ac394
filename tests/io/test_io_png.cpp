#include <gtest/gtest.h>

#include <cstddef>

#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
std::uint32_t big_endian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t b = at; b < at + 4; ++b) {
    value = value << 8 | static_cast<unsigned char>(bytes[b]);
  }
  return value;
}

/// The first chunk of a PNG holds width, height, 8 bits, color type 2 (RGB).
TEST(Png, WritesAnRgbPictureOfTheGivenSize) {
  const ScratchFolder folder;
  const Image image{3, 2, std::vector<std::uint8_t>(18, 77)};

  write_png(folder / "p.png", image);
  std::ifstream file(folder / "p.png", std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(file), {});

  EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(big_endian(bytes, 16), 3U);
  EXPECT_EQ(big_endian(bytes, 20), 2U);
  EXPECT_EQ(bytes.substr(24, 2), "\x08\x02");
  EXPECT_EQ(folder.entry_count(), 1);
}

TEST(Png, RefusesPicturesWithoutAllPixels) {
  const ScratchFolder folder;

  EXPECT_THROW(write_png(folder / "p.png", {3, 2, std::vector<std::uint8_t>(17)}), IoError);
  EXPECT_THROW(write_png(folder / "p.png", {0, 2, {}}), IoError);
  EXPECT_THROW(write_png(folder / "p.png", {-3, -2, std::vector<std::uint8_t>(18)}), IoError);
  EXPECT_EQ(folder.entry_count(), 0);
}

TEST(Png, NamesTheFolderThatCannotBeMade) {
  const ScratchFolder folder;
  const Image image{1, 1, {0, 0, 0}};

  const std::string error = io_error([&] {
    write_png(folder / "file", image);
    write_png(folder / "file/none/p.png", image);
  });

  EXPECT_NE(error.find("file/none' cannot be made: Not a directory"), std::string::npos) << error;
}
}  // namespace
}  // namespace tetwarp::test
