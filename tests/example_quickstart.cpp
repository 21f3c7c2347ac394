/// @file example_quickstart.cpp
/// The README's example, and a check that it did what it says.
// [quickstart]
#include <tetwarp/io.hpp>
#include <tetwarp/tetwarp.hpp>

// [quickstart]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

namespace {

void expect(bool condition, const char* claim) {
  if (condition) return;
  std::fprintf(stderr, "quick start: not so: %s\n", claim);
  std::exit(1);
}

}  // namespace

int main() {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / "tetwarp-quickstart";
  fs::create_directories(folder);
  fs::current_path(folder);

  // [quickstart]
  tetwarp::Volume phantom = tetwarp::make_phantom({128, 80, 61});
  tetwarp::Mesh mesh = tetwarp::make_lattice_mesh(phantom);
  auto twisted = tetwarp::deform_positions(mesh, {.kind = tetwarp::Deformation::twist}, 1.0);
  tetwarp::WarpResult result = tetwarp::warp(phantom, mesh, twisted);
  tetwarp::write_volumes("twisted.vtkhdf", {&result.volume});
  // [quickstart]

  const tetwarp::Volume read = tetwarp::read_volume("twisted.vtkhdf");
  fs::current_path(folder.parent_path());
  fs::remove_all(folder);
  expect(read.data == result.volume.data, "the file holds the warped volume");
  expect(read.grid.dims == phantom.grid.dims, "the output has the source's grid");
  expect(result.report.counts.covered > 100000, "the mesh covers the body");
  expect(result.volume.data != phantom.data, "the body is twisted");
  expect(std::ranges::max(read.samples<float>()) <= std::ranges::max(phantom.samples<float>()),
         "no sample is invented");
  return 0;
}
