/// @file choices.hpp
/// Enums of options that the kernels read too. <tetwarp/volume.hpp> and <tetwarp/contact.hpp>
/// include this header.
#pragma once
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace tetwarp {

/// Type of one sample.
enum class PixelType : std::uint8_t {
  uint8,    ///< std::uint8_t
  int8,     ///< std::int8_t
  uint16,   ///< std::uint16_t
  int16,    ///< std::int16_t
  uint32,   ///< std::uint32_t
  int32,    ///< std::int32_t
  uint64,   ///< std::uint64_t
  int64,    ///< std::int64_t
  float32,  ///< float
  float64   ///< double
};

/// The enumerator of an arithmetic C++ type of 1 to 8 bytes; bool and long double do not compile.
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

/// How the source is interpolated between voxel centers. At a voxel center every filter returns the
/// sample itself. Order p: for smooth images the error falls with the p-th power of the voxel size.
enum class Filter {
  nearest,  ///< the nearest sample; order 1
  linear,   ///< trilinear, 2x2x2 samples; order 2
  cubic,    ///< Catmull-Rom, 4x4x4 samples; order 3
  bspline,  ///< cubic spline through the samples, mirrored at the boundary of the source; order 4
  lanczos,  ///< sinc with a window of three lobes, 6x6x6 samples; sharp, but only of order 1
  labels  ///< the label with the largest sum of linear weights, the lowest of several; one integer
          ///< component
};

/// What the components of a source mean, and how the deformation changes them.
///
/// F is the deformation gradient in world axes, constant in a tetrahedron; R is the rotation
/// nearest to F, also for inverted tetrahedra (det R = +1). Components are along world axes, as in
/// VTK, also on oblique grids.
enum class Quantity {
  components,            ///< independent numbers, any count: unchanged
  vector,                ///< 3 components: R v
  covariant_vector,      ///< 3 components, for example gradients: F^-T v
  contravariant_vector,  ///< 3 components, for example material line elements: F v
  tensor,                ///< symmetric, 6 components XX YY ZZ XY YZ XZ: R D R^T
  principal_tensor       ///< as `tensor`, with the rotation that takes the first eigenvector e1 to
                         ///< the direction of F e1 and e2 into the plane of F e1 and F e2
                         ///< (D. C. Alexander et al., 2001); eigenvalues unchanged
};

/// How contacts are solved. Use `automatic`; the others are for comparing solvers: each runs one
/// method to the end, even if it converges slowly or not at all.
enum class ContactMethod {
  automatic,     ///< Anderson-accelerated sweeps; other methods when the residual stagnates
  gauss_seidel,  ///< expert: projected Gauss-Seidel, color by color
  nonlinear_cg,  ///< expert: nonsmooth nonlinear conjugate gradients over sweeps
  anderson,      ///< expert: Anderson acceleration of sweeps, window 8
  newton         ///< expert: sweeps, then semismooth Newton on the natural map (host, per island)
};

/// The residual that ContactOptions::tolerance bounds. Both are relative numbers without unit.
enum class ContactMeasure {
  eta,   ///< natural-map residual weighted by energy, with the matrix A of the problem
  fclib  ///< error of the FCLIB benchmarks: norm of u~ - P(u~ - r) over all contacts, over |q|
};

}  // namespace tetwarp
