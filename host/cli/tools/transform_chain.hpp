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
  std::int64_t not_inverted = 0;  ///< of a field: no position was found that it takes there
  double largest_residual = 0;    ///< of those found [world]
};

/// One transform from positions of the output to positions in the source.
class ChainLink {
 public:
  /// @param word  path of the file; with "^-1" behind it the inverse
  ChainLink(const std::string& word, const MeshReadOptions& mesh, const std::optional<Axes>& axes);

  /// The path in a word of the constructor.
  static std::string path_of(const std::string& word) {
    return word.substr(0, word.size() - (word.ends_with("^-1") ? 3 : 0));
  }

  const std::string& path() const { return path_; }
  const std::optional<MeshReader>& mesh() const { return mesh_; }  ///< of other links none
  std::int64_t step_count() const;                                 ///< 1 but for meshes
  bool iterates() const;  ///< it is the inverse of a field or a spline, by fixed point

  /// @param step  of a mesh; one with a single step takes that
  void apply(std::int64_t step, int threads, std::vector<Point3>& points, ChainNotes& notes) const;

 private:
  std::string path_;
  bool is_inverse_;
  std::optional<MeshReader> mesh_;
  std::vector<Transform> transforms_;  ///< in the order of application, no chains; of an inverse
                                       ///< affine ones are inverted
};

/// The inverse. Throws std::invalid_argument when the matrix is singular.
AffineTransform inverse_of(const AffineTransform& affine);

}  // namespace tetwarp::cli
