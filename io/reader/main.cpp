/// @file main.cpp
/// The program tetwarp-read: reads one mesh by VTK or Gmsh, or one image by GDCM or VTK, and sends
/// it to the program that has started it, gives the points of a file new places, or makes a
/// surface coarser.
#include <cstdlib>

#include "io/reader/image_readers.hpp"
#include "io/reader/mesh_readers.hpp"
#include "io/reader/mesh_sender.hpp"

int main(int argc, char** argv) {
  // Without the exit handlers of the libraries, which may crash after a damaged file.
  std::_Exit(tetwarp::send_result(
      argc, argv,
      {tetwarp::read_foreign_mesh, tetwarp::read_vtk_points, tetwarp::place_vtk_points,
       tetwarp::read_foreign_image, tetwarp::read_foreign_samples, tetwarp::coarsen_by_vtk}));
}
