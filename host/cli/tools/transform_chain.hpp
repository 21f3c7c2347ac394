/// @file transform_chain.hpp
/// Meshes and transforms one after the other.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/resample.hpp>
#include <tetwarp/transform_file.hpp>

namespace tetwarp::cli {

/// What points met on their way.
struct ChainNotes {
  std::int64_t outside = 0;       ///< of a mesh: they kept their place there
  std::int64_t straightened = 0;  ///< of a mesh: moved by straight tetrahedra, see CurvedMesh
  std::int64_t not_inverted = 0;  ///< of a field: no position is taken there; kept their place
  double largest_residual = 0;    ///< of those found [world]
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
  bool iterates() const;  ///< it has the inverse of a field or a spline, see invert_field()

  /// Chooses the step that is applied; a file with a single step keeps that.
  void choose(std::int64_t step);
  void apply(int threads, std::vector<Point3>& points, ChainNotes& notes) const;

 private:
  /// One transform, no chain.
  struct Part {
    Transform transform;
    bool is_inverse = false;  ///< to be applied; never of affine transforms
  };

  void read_transforms();

  std::string path_;
  bool is_inverse_;
  TransformReadOptions options_;  ///< with the chosen step, also of a mesh
  std::int64_t field_steps_ = 1;
  std::optional<MeshReader> mesh_;
  std::vector<Part> parts_;  ///< in the order of application
};

/// The inverse. Throws std::invalid_argument when the matrix is singular.
AffineTransform inverse_of(const AffineTransform& affine);

}  // namespace tetwarp::cli
