/// @file fake_reader.cpp
/// In place of tetwarp-read: a reader that ends as the name of its file says.
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <tetwarp/missing_library.hpp>
#include <vector>

#include "io/reader/mesh_sender.hpp"

namespace tetwarp {
namespace {
void allocate() {
  std::vector<std::vector<char>> blocks;
  for (int block = 0; block < 64; ++block) blocks.emplace_back(std::size_t{1} << 24, 'x');
}

void print() {
  std::printf("corrupted size\n");
  std::fprintf(stderr, "corrupted size\n");
  std::fflush(stdout);
}

/// Two steps of two tetrahedra.
ImportedMesh two_steps() {
  return {{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}, {{0, 1, 2, 3}, {1, 2, 3, 4}}},
          {std::vector<Point3>(5, Point3{1, 0, 0}), std::vector<Point3>(5, Point3{2, 0, 0})},
          {0.5, 2},
          {{"triangle", 3}, {"line", 1}}};
}

ImportedMesh read(const std::string& path, const MeshImportOptions& options) {
  const std::map<std::string, std::function<void()>> ends = {
      {"segfault", [] { std::signal(SIGSEGV, SIG_DFL), raise(SIGSEGV); }},
      {"abort", [] { std::abort(); }},
      {"end", [] { _exit(0); }},
      {"exit", [] { std::exit(3); }},
      {"library", [] { _exit(127); }},  // as the system's loader
      {"hang", [] { pause(); }},
      {"allocate", allocate},
      {"print", print},
      {"missing", [&] { throw MissingLibrary(path, "VTK", "this build cannot read it"); }},
      {"io error", [&] { throw IoError(path, "u", "expected three components"); }},
      {"error", [] { throw std::runtime_error("odd"); }}};
  if (const auto end = ends.find(path); end != ends.end()) end->second();
  ImportedMesh mesh = two_steps();
  if (path == "large") mesh.mesh.rest_positions.assign(500'000, Point3{1, 2, 3});
  if (path.ends_with("moved.vtu")) mesh.left_out = {"point array 'displacement'"};
  if (path.ends_with(".vtu")) mesh.triangles = {{0, 1, 2}};
  mesh.merged = options.displacement.value_or("none") + (options.needs_solids ? ", solids" : "");
  return mesh;
}

/// Of one array of bytes. @param path  "wide": the image that the samples of "changed" belong to
ForeignImage image(const std::string& path, const std::string&) {
  ForeignImage image;
  image.grid.dims = {path == "wide" ? 6 : 2, 3, 2};
  image.arrays = {{"density", PixelType::uint8, 1}};
  image.active = "density";
  return image;
}

void samples(const std::string& path,
             const std::string&,
             const std::string& series,
             const TakeImage& take_image,
             const TakeSlice& take) {
  take_image(image(path == "changed" ? "wide" : path, series));
  const std::string slice = "abcdef";
  take(slice.data(), slice.size());
  take(slice.data(), slice.size());
}
}  // namespace
}  // namespace tetwarp

int main(int argc, char** argv) {
  const std::string path = argc > 1 ? argv[1] : "";
  if (path == "truncated") return write(STDOUT_FILENO, "\0\1\2\3", 4) == 4 ? 0 : 1;
  std::_Exit(
      tetwarp::send_result(argc, argv, {tetwarp::read, {}, {}, tetwarp::image, tetwarp::samples}));
}
