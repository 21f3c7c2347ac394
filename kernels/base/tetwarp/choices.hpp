/// @file choices.hpp
/// Enums of public options that kernels read too.
#pragma once
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace tetwarp {

/// Type of one sample.
enum class PixelType : std::uint8_t {
  uint8,
  int8,
  uint16,
  int16,
  uint32,
  int32,
  uint64,
  int64,
  float32,
  float64
};

/// The enumerator of a C++ type.
template <class T>
constexpr PixelType pixel_type_of() {
  static_assert(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>, "a numeric pixel type");
  if constexpr (std::is_floating_point_v<T>) {
    static_assert(sizeof(T) == 4 || sizeof(T) == 8, "float32 or float64");
    return sizeof(T) == 4 ? PixelType::float32 : PixelType::float64;
  } else {
    constexpr int size = sizeof(T) == 1 ? 0 : sizeof(T) == 2 ? 2 : sizeof(T) == 4 ? 4 : 6;
    return static_cast<PixelType>(size + (std::is_signed_v<T> ? 1 : 0));
  }
}

/// How the source is sampled between voxel centres. At a centre every filter gives the voxel's own
/// sample. Order n: the error falls with the n-th power of the voxel size.
enum class Filter {
  nearest,  ///< order 1
  linear,   ///< order 2
  cubic,    ///< Catmull-Rom, 4x4x4 samples: order 3
  bspline,  ///< cubic spline through the samples, mirrored at the source's border: order 4
  lanczos,  ///< windowed sinc, 6x6x6 samples: the sharpest for coarse images, but of no high order
  labels    ///< the label with the largest linear weight, the lowest if tied; integers only
};

/// What the components of a source are, and how the deformation reorients them. F is the
/// deformation gradient in world axes, constant in a tetrahedron; R the proper rotation nearest to
/// F, also in inverted tetrahedra. Components are along world axes, on oblique grids too, as in
/// VTK.
enum class Quantity {
  components,            ///< independent numbers, not reoriented
  vector,                ///< 3 components: R v
  covariant_vector,      ///< F^-T v, as gradients transform
  contravariant_vector,  ///< F v, as material lines transform
  tensor,                ///< symmetric, 6 components XX YY ZZ XY YZ XZ: R D R^T
  principal_tensor  ///< a tensor whose eigenvalues stay; the first eigenvector e1 becomes F e1, the
                    ///< second lies in the plane of F e1 and F e2 (D. C. Alexander et al., 2001)
};

/// How contacts are solved. `automatic` is the one to use; the others are for experts who compare
/// solvers.
enum class ContactMethod {
  automatic,       ///< accelerated sweeps, and others in turn when the residual stops dropping
  gauss_seidel,    ///< projected Gauss-Seidel over colors
  nonlinear_cg,    ///< nonsmooth nonlinear conjugate gradients over sweeps
  anderson,        ///< Anderson acceleration of sweeps, window 8
  mass_splitting,  ///< no colors: split masses, Nesterov with restart
  newton           ///< sweeps, then semismooth Newton on the natural map (host, per island)
};

/// The error measure that ContactOptions::tolerance bounds.
enum class ContactMeasure {
  eta,   ///< energy-weighted natural residual, relative, with the true A; free of units
  fclib  ///< FCLIB's natural-map error: |u~ - P(u~ - r)| accumulated, relative to |q|
};

}  // namespace tetwarp
