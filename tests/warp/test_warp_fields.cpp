/// @file test_warp_fields.cpp
/// Fields of the deformation beside the warped volume, on every back end.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/affine_scenes.hpp"
#include "tests/support/each_backend.hpp"
#include "tests/support/field_buffers.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

/// A step with all its fields.
struct Fielded {
  Volume volume;
  std::vector<std::int32_t> owner;
  FieldBuffers fields;
};

class WarpFields : public EachBackend {
 protected:
  static Fielded run(const Volume& source,
                     const scenes::Scene& scene,
                     Backend backend,
                     WarpOptions options = {}) {
    options.backend = backend;
    options.output_grid = scene.output_grid;
    Warper warper(source, scene.mesh, options);
    const Grid& grid = warper.output_grid();
    Fielded result{make_volume(grid, source.type, source.components),
                   std::vector<std::int32_t>(static_cast<std::size_t>(grid.voxel_count()), -99),
                   FieldBuffers(grid, scene.source_grid == scene.output_grid)};
    void* const data = result.volume.data.data();
    warper.step(
        scene.deformed,
        {.volumes = {&data, 1}, .owner = result.owner.data(), .fields = result.fields.target()});
    return result;
  }
};
INSTANTIATE_TEST_SUITE_P(Backends, WarpFields, each_backend, name_of_backend);

Vector place_of(const Grid& grid, std::size_t voxel) {
  const auto v = static_cast<std::int64_t>(voxel);
  const auto& n = grid.dims;
  const std::int64_t row = v / n[0], slice = row / n[1];
  return vector_of(grid.world_of({static_cast<double>(v % n[0]), static_cast<double>(row % n[1]),
                                  static_cast<double>(slice)}));
}

/// Largest difference of a voxel's components from what they should be.
template <class Derived>
double error_at(const std::vector<float>& field,
                std::size_t voxel,
                const Eigen::MatrixBase<Derived>& expected) {
  double largest = 0;
  const auto count = static_cast<std::size_t>(expected.size());
  for (std::size_t c = 0; c < count; ++c) {
    const double value = field[voxel * count + c];
    largest = std::max(largest, std::abs(value - expected(static_cast<Eigen::Index>(c))));
  }
  return largest;
}

/// Nothing moves, everything by whole voxels, and a stretch with shear, partly out of the grid.
/// Nodes are rounded to 1e-6 voxel, tetrahedra are three voxels long.
TEST_P(WarpFields, AreThoseOfAnAffineMotionAndZeroOutside) {
  const Grid grid = scenes::oblique_grid(14, 12, 13);
  const Mesh mesh = covering_mesh(grid);
  Matrix stretch;
  stretch << 1.2, 0.3, 0, -0.1, 0.9, 0.2, 0, 0.05, -1.1;
  const Vector center = vector_of(grid.world_of({5, 6, 7}));
  const Vector whole = vector_of(grid.world_of({2, -1, 3})) - vector_of(grid.origin);
  struct Motion {
    Matrix gradient;
    Vector shift;
    double tolerance;
  };
  const double exact = GetParam() == Backend::reference ? 1e-12 : 0;
  for (const Motion& motion :
       {Motion{Matrix::Identity(), Vector::Zero(), exact}, Motion{Matrix::Identity(), whole, 2e-6},
        Motion{stretch, Vector{0.3, 1, -2}, 1e-5}}) {
    const auto moved_place = [&](const Vector& x) -> Vector {
      return motion.gradient * (x - center) + center + motion.shift;
    };
    scenes::Scene scene = {"affine", mesh, mesh.rest_positions, grid, grid};
    for (Point3& p : scene.deformed) {
      const Vector x = moved_place(vector_of(p));
      p = {x(0), x(1), x(2)};
    }
    const Matrix e = (motion.gradient.transpose() * motion.gradient - Matrix::Identity()) / 2;
    Eigen::Matrix<double, 6, 1> strain;
    strain << e(0, 0), e(1, 1), e(2, 2), e(0, 1), e(1, 2), e(0, 2);
    const Matrix by_rows = motion.gradient.transpose();  // Eigen counts by columns

    const Fielded warped = run(scenes::wavy_volume(grid, PixelType::uint8), scene, GetParam());

    const FieldBuffers& fields = warped.fields;
    std::size_t covered = 0;
    for (std::size_t v = 0; v < warped.owner.size(); ++v) {
      SCOPED_TRACE(v);
      const Vector x = place_of(grid, v);
      ASSERT_LE(error_at(fields.forward(), v, moved_place(x) - x), motion.tolerance);
      const bool is_covered = warped.owner[v] >= 0;
      covered += is_covered;
      const double one = is_covered ? 1 : 0;
      const Vector rest = motion.gradient.inverse() * (x - center - motion.shift) + center;
      ASSERT_LE(error_at(fields.displacement(), v, one * (rest - x)), one * motion.tolerance);
      ASSERT_LE(error_at(fields.gradient(), v, one * by_rows.reshaped()), one * motion.tolerance);
      ASSERT_LE(error_at(fields.strain(), v, one * strain), one * motion.tolerance);
      ASSERT_NEAR(fields.jacobian()[v], one * motion.gradient.determinant(),
                  one * motion.tolerance);
    }
    EXPECT_GT(covered, 500U);
  }
}

/// To float32's rounding of the largest component, 1e-6 voxel of rounding being common to all.
TEST_P(WarpFields, AreTheReference) {
  if (GetParam() == Backend::reference) GTEST_SKIP() << "the reference is not compared with itself";
  for (const char* name :
       {"waved", "oblique", "slivers_1", "folded", "flat", "far", "other_grid"}) {
    SCOPED_TRACE(name);
    const scenes::Scene scene = scenes::adversarial_scene(name, 18);
    const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::int16);
    for (const bool whole : {true, false}) {
      WarpOptions options;
      if (!whole) {
        const auto& n = scene.output_grid.dims;
        options.region = Region{{3, 5, 9}, {n[0] - 1, n[1] - 2, n[2]}};
      }

      const Fielded warped = run(source, scene, GetParam(), options);
      const Fielded reference = run(source, scene, Backend::reference, options);

      for (std::size_t f = 0; f < warped.fields.arrays().size(); ++f) {
        const std::vector<float>& found = warped.fields.arrays()[f];
        const std::vector<float>& expected = reference.fields.arrays()[f];
        const std::size_t count = FieldBuffers::components[f];
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t v = 0; v < found.size() / count; ++v) {
          const auto voxel = expected.begin() + static_cast<std::ptrdiff_t>(v * count);
          float largest = 1;
          std::for_each_n(voxel, count, [&](float x) { largest = std::max(largest, std::abs(x)); });
          for (std::size_t c = v * count; c < (v + 1) * count; ++c) {
            ASSERT_NEAR(found[c], expected[c], 1e-6 * largest) << "field " << f << " at " << v;
          }
        }
      }
    }
  }
}

/// A source whose samples are its own positions shows the source position of every voxel, without
/// interpolation error for linear filters. The forward field is the displacement when meshes are
/// exchanged.
TEST_P(WarpFields, DisplaceAsTheWarpDoesAndForwardIsTheInverse) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 18);
  Volume places = make_volume(scene.source_grid, PixelType::float64, 3);
  const auto samples = places.samples<double>();
  for (std::size_t v = 0; v < samples.size() / 3; ++v) {
    const Vector x = place_of(scene.source_grid, v);
    std::copy_n(x.data(), 3, samples.data() + 3 * v);
  }
  scenes::Scene exchanged = scene;
  std::swap(exchanged.mesh.rest_positions, exchanged.deformed);

  const Fielded warped = run(places, scene, GetParam());
  const Fielded back = run(places, exchanged, GetParam());

  const Grid& grid = scene.output_grid;
  constexpr double margin = 1e-3;  // beyond the rim samples repeat
  const Point3 first = grid.world_of({margin, margin, margin});
  const Point3 last = grid.world_of({static_cast<double>(grid.dims[0] - 1) - margin,
                                     static_cast<double>(grid.dims[1] - 1) - margin,
                                     static_cast<double>(grid.dims[2] - 1) - margin});
  std::size_t compared = 0;
  for (std::size_t v = 0; v < warped.owner.size(); ++v) {
    const double* const shown = warped.volume.samples<double>().data() + 3 * v;
    bool is_within = warped.owner[v] >= 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      is_within = is_within && shown[axis] > first[axis] && shown[axis] < last[axis];
    }
    if (!is_within) continue;
    ++compared;
    const Vector from = Eigen::Map<const Vector>(shown) - place_of(grid, v);
    ASSERT_LE(error_at(warped.fields.displacement(), v, from), 1e-6) << v;
  }
  EXPECT_GT(compared, 500U);
  EXPECT_EQ(warped.fields.forward(), back.fields.displacement());
  EXPECT_EQ(warped.fields.displacement(), back.fields.forward());
}
}  // namespace
}  // namespace tetwarp::test
