/// @file simulate_bodies.hpp
/// The mesh files of the bodies of a simulation: NAME.vtkhdf and NAME.surface.vtkhdf.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/simulate.hpp>

#include "host/cli/simulate/simulate_contacts.hpp"
#include "host/view/look/look_surfaces.hpp"
#include "io/vtkhdf/simulation_mesh.hpp"

namespace tetwarp::cli {

/// A body with tetrahedra has them in NAME.vtkhdf and its triangles in NAME.surface.vtkhdf, with a
/// finer surface for the eye in NAME.look.vtkhdf. A body
/// without has its triangles in NAME.vtkhdf, to which NAME.surface.vtkhdf is a link. A body without
/// geometry has no file.
class BodyFiles {
 public:
  /// @param kept_steps  number of steps to keep of the files of an earlier run, which are opened
  /// and
  ///                    not changed before drop_later(); negative: files are created
  BodyFiles(Simulator& simulator, const std::string& folder, std::int64_t kept_steps);

  /// Removes the steps of an earlier run that are not kept.
  void drop_later();

  /// Appends the state of the simulator to all files. The values stay in memory until flush(),
  /// which is called when they take more than 64 MiB.
  void append();
  void flush();

  /// Names of the files.
  const std::vector<std::string>& paths() const { return paths_; }

 private:
  enum class Points { nodes, surface, look };
  struct File {
    std::size_t body;
    Points points;
    std::vector<StepArray> arrays;
    StepMeshWriter writer;
  };

  std::vector<StepArray> arrays_of(std::size_t body, Points points) const;
  void open(std::size_t body, Points points, const std::string& path, std::int64_t kept_steps);
  std::vector<double> values_of(const File& file, const StepArray& array) const;
  std::vector<Point3> velocities_of(const File& file) const;
  bool has_field(const std::string& name) const;

  const std::vector<Point3>& rest_points(const File& file) const;
  std::vector<Point3> positions_of(const File& file) const;

  Simulator& simulator_;
  view::LookSurfaces looks_;
  std::vector<File> files_;
  std::vector<std::string> paths_;
  std::size_t kept_bytes_ = 0;
  std::vector<ContactFields> contacts_;  ///< of the last append()
};

}  // namespace tetwarp::cli
