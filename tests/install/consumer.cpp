/// @file consumer.cpp
/// A stranger's program: warps a phantom with what was installed and, where tetwarp::io was
/// installed, stores it. Fails when a voxel is lost on the way.
#include <cstdio>
#include <tetwarp/tetwarp.hpp>

#if defined(WITH_IO)
#include <tetwarp/io.hpp>
#endif

int main() {
  const tetwarp::Volume source = tetwarp::make_phantom({32, 20, 16});
  const tetwarp::Mesh mesh = tetwarp::make_lattice_mesh(source);
  const tetwarp::WarpOptions options{.backend = tetwarp::Backend::cpu};
  const tetwarp::WarpResult still = tetwarp::warp(source, mesh, mesh.rest_positions, options);
  if (still.volume.data != source.data) {
    std::puts("an undeformed mesh changed the volume");
    return 1;
  }
#if defined(WITH_IO)
  tetwarp::write_volumes("consumer.vtkhdf", {&still.volume});
  if (tetwarp::read_volume("consumer.vtkhdf").data != source.data) {
    std::puts("a file changed the volume");
    return 1;
  }
#endif
  std::printf("tetwarp %s: %lld voxels, unchanged\n", TETWARP_VERSION,
              static_cast<long long>(still.report.counts.voxels));
  return 0;
}
