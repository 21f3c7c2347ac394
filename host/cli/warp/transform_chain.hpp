/// @file transform_chain.hpp
/// Meshes and transforms one after the other.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/transform_file.hpp>

#include "host/warp/compose/compose.hpp"

namespace tetwarp::cli {

/// One transform of a file from positions of the output to positions in the source.
class ChainLink {
 public:
  /// @param word   path of the file; with "^-1" behind it the inverse
  /// @param world  of the points; see TransformReadOptions
  ChainLink(const std::string& word,
            const MeshReadOptions& mesh,
            const std::optional<Axes>& axes,
            const std::optional<Point3>& world);

  /// The path in a word of the constructor.
  static std::string path_of(const std::string& word) {
    return word.substr(0, word.size() - (word.ends_with("^-1") ? 3 : 0));
  }

  const std::string& path() const { return path_; }
  const std::optional<MeshReader>& mesh() const { return mesh_; }  ///< of other links none
  std::int64_t step_count() const;                                 ///< 1 but for meshes and fields
  bool iterates() const;  ///< it has the inverse of a field or a spline, see FieldInverse

  /// Chooses the step that is applied, and reads the positions of a mesh; a file with a single step
  /// keeps that.
  void choose(std::int64_t step);
  /// Those of the chosen step, in the order in which positions of the output meet them.
  /// @pre choose() has been called
  const std::vector<ComposeLink>& parts() const { return parts_; }

 private:
  void read_transforms();

  std::string path_;
  bool is_inverse_;
  TransformReadOptions options_;  ///< with the chosen step, also of a mesh
  std::int64_t field_steps_ = 1;
  std::optional<MeshReader> mesh_;
  std::vector<ComposeLink> parts_;  ///< affine transforms are inverted
};

/// What the chosen step met on its way.
/// @param links          in the order in which they are applied to an image, which is the reverse
///                       of that for positions of the output
/// @param threads        0: all cores
/// @param displacements  out, of the voxels of the grid, see compose_into()
ComposeNotes composed(std::span<const ChainLink> links,
                      const Grid& grid,
                      int threads,
                      std::span<float> displacements);

/// A line about each kind of positions that kept their place or have another one than meant.
/// @param count  of all positions
std::vector<std::string> lines_of(const ComposeNotes& notes, std::int64_t count);

}  // namespace tetwarp::cli
