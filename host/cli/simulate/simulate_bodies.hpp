/// @file simulate_bodies.hpp
/// The mesh files of the bodies of a simulation: NAME.vtkhdf and NAME.surface.vtkhdf.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/simulate.hpp>

#include "host/cli/simulate/simulate_contacts.hpp"
#include "io/vtkhdf/simulation_mesh.hpp"

namespace tetwarp::cli {

/// Bodies with tetrahedra have these in NAME.vtkhdf and their triangles in NAME.surface.vtkhdf.
/// Others have triangles in NAME.vtkhdf, to which NAME.surface.vtkhdf is a link. Bodies without
/// geometry have no file.
class BodyFiles {
 public:
  /// @param kept_steps  opens the files of an earlier run to append behind this number of steps,
  /// and
  ///                    changes nothing before drop_later(); negative: creates files
  BodyFiles(Simulator& simulator, const std::string& folder, std::int64_t kept_steps);

  /// Removes the steps of an earlier run that are not kept.
  void drop_later();

  /// Appends the state of the simulator to all files. It is kept for flush() to write, up to 64 MiB
  /// in all.
  void append();
  void flush();

  /// Names of the files.
  const std::vector<std::string>& paths() const { return paths_; }

 private:
  enum class Points { nodes, surface };
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

  Simulator& simulator_;
  std::vector<File> files_;
  std::vector<std::string> paths_;
  std::size_t kept_bytes_ = 0;
  std::vector<ContactFields> contacts_;  ///< of the state that append() writes
};

}  // namespace tetwarp::cli
