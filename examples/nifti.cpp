/// @file nifti.cpp
/// Warps a NIfTI image: `nifti IN.nii.gz OUT.nii.gz`. Without arguments it first writes a phantom
/// and warps that.
#include <cstdio>
#include <exception>
#include <string>
#include <tetwarp/io.hpp>
#include <tetwarp/tetwarp.hpp>

int main(int argc, char** argv) {
  if (argc != 1 && argc != 3) {
    std::fprintf(stderr, "usage: nifti [IN.nii.gz OUT.nii.gz]\n");
    return 2;
  }
  const std::string in = argc == 3 ? argv[1] : "phantom.nii.gz";
  const std::string out = argc == 3 ? argv[2] : "bent.nii.gz";
  try {
    if (argc == 1) tetwarp::write_nifti(in, tetwarp::make_phantom({96, 60, 46}));
    const tetwarp::Volume image = tetwarp::read_nifti(in);
    const tetwarp::Mesh mesh = tetwarp::make_lattice_mesh(image);
    const auto bent = tetwarp::deform_positions(mesh, {.kind = tetwarp::Deformation::bend}, 1.0);
    const tetwarp::Volume warped = tetwarp::warp(image, mesh, bent).volume;
    tetwarp::write_nifti(out, warped);
    std::printf("%s -> %s: %lld x %lld x %lld voxels\n", in.c_str(), out.c_str(),
                static_cast<long long>(image.grid.dims[0]),
                static_cast<long long>(image.grid.dims[1]),
                static_cast<long long>(image.grid.dims[2]));
    return tetwarp::read_nifti(out).data == warped.data ? 0 : 1;
  } catch (const std::exception& error) {  // what() is one line that names the bad argument or file
    std::fprintf(stderr, "nifti: %s\n", error.what());
    return 1;
  }
}
