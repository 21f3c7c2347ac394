/// @file quickstart.cpp
/// Warps a phantom by a twisted lattice of tetrahedra and writes twisted.vtkhdf for ParaView.
#include <cstdio>
#include <tetwarp/io.hpp>
#include <tetwarp/tetwarp.hpp>

int main() {
  tetwarp::Volume phantom = tetwarp::make_phantom({128, 80, 61});
  tetwarp::Mesh mesh = tetwarp::make_lattice_mesh(phantom);
  auto twisted = tetwarp::deform_positions(mesh, {.kind = tetwarp::Deformation::twist}, 1.0);
  tetwarp::WarpResult result = tetwarp::warp(phantom, mesh, twisted);
  tetwarp::write_volumes("twisted.vtkhdf", {&result.volume});

  std::printf("twisted.vtkhdf: %lld of %lld voxels covered by the mesh\n",
              static_cast<long long>(result.report.counts.covered),
              static_cast<long long>(result.report.counts.voxels));
  const tetwarp::Volume read = tetwarp::read_volume("twisted.vtkhdf");
  return read.data == result.volume.data && read.data != phantom.data ? 0 : 1;
}
