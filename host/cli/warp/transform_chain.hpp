/// @file transform_chain.hpp
/// Meshes and transforms one after the other.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/resample.hpp>
#include <tetwarp/transform_file.hpp>

#include "host/cli/warp/field_inverse.hpp"

namespace tetwarp::cli {

/// What points met on their way.
struct ChainNotes {
  std::int64_t outside = 0;       ///< of a mesh: they kept their place there
  std::int64_t straightened = 0;  ///< of a mesh: moved by straight tetrahedra, see CurvedMesh
  std::int64_t not_inverted = 0;  ///< of a field: no position is taken there; kept their place
  double largest_residual = 0;    ///< of those found [world]

  /// A line about each, of positions that kept their place or have another one than meant.
  /// @param count  of all positions
  std::vector<std::string> lines(std::int64_t count) const;
};

/// One transform from positions of the output to positions in the source.
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

  /// Chooses the step that is applied, and reads it; of a file with a single step that one.
  void choose(std::int64_t step);
  /// @pre choose() has been called
  void apply(int threads, std::vector<Point3>& points, ChainNotes& notes);

 private:
  using Part = std::variant<Transform, FieldInverse>;  ///< one transform, no chain

  void read_transforms();
  Part part_of(Transform transform, bool is_inverse) const;

  std::string path_;
  bool is_inverse_;
  TransformReadOptions options_;  ///< with the chosen step, also of a mesh
  std::int64_t field_steps_ = 1;
  std::optional<MeshReader> mesh_;
  std::vector<Point3> deformed_;  ///< nodes of the mesh in the chosen step
  std::vector<Part> parts_;       ///< in the order of application
};

/// Where links take the voxels of a grid, the last one first, less where they are.
/// @param links  the first one is the last transform of a position, as the first one of an image
/// @returns [k][j][i][3] [world]
std::vector<float> displacements_of(std::span<ChainLink> links,
                                    const Grid& grid,
                                    int threads,
                                    ChainNotes& notes);

/// Memory that displacements_of() a grid take with the result [byte].
double displacement_memory(const Grid& grid);

/// The inverse. Throws std::invalid_argument when the matrix is singular.
AffineTransform inverse_of(const AffineTransform& affine);

}  // namespace tetwarp::cli
