/// @file nifti_components.cpp
/// Turns components between the order of files and that of volumes.
#include "io/nifti/nifti_components.hpp"

#include <nifti1.h>

#include <cmath>
#include <cstring>
#include <tetwarp/error.hpp>
#include <tetwarp/nifti.hpp>

namespace tetwarp {
namespace {
/// NIfTI stores the lower triangle row by row, xx xy yy xz yz zz; VTK's order is xx yy zz xy yz xz.
constexpr std::array<std::size_t, 9> vtk_place_of_symmatrix = {0, 3, 1, 5, 4, 2, 6, 7, 8};

/// Replaces each sample by change(sample).
template <class T, class Change>
void change_each(std::span<std::byte> samples, const Change& change) {
  for (std::size_t at = 0; at < samples.size(); at += sizeof(T)) {
    T sample;
    std::memcpy(&sample, samples.data() + at, sizeof sample);
    sample = change(sample);
    std::memcpy(samples.data() + at, &sample, sizeof sample);
  }
}
}  // namespace

std::array<bool, 9> turned_components(int components) {
  if (components == 3) return {true, true};
  if (components == 6) return {false, false, false, false, true, true};
  if (components == 9) return {false, false, true, false, false, true, true, true, false};
  return {};
}

ComponentMap component_map(
    const std::string& path, PixelType type, int components, int intent_code, Axes axes) {
  const bool is_symmetric = intent_code == NIFTI_INTENT_SYMMATRIX && components == 6;
  ComponentMap map{{0, 1, 2, 3, 4, 5, 6, 7, 8}, {}, components};
  if (is_symmetric) map.place = vtk_place_of_symmatrix;
  if (axes == Axes::ras) return map;
  const bool is_turnable = components == 3 || components == 9 || is_symmetric;
  if (!is_turnable || is_integer(type)) {
    throw IoError(path, "",
                  "holds " + std::to_string(components) + " component" +
                      (components == 1 ? "" : "s") + " of " + name_of(type) + ", intent code " +
                      std::to_string(intent_code) +
                      "; --axes lps turns vectors (3), tensors (9) and symmetric tensors (6, "
                      "intent code 1005) of float32 or float64; leave it out");
  }
  const std::array<bool, 9> turned = turned_components(components);
  for (std::size_t c = 0; c < 9; ++c) map.is_negated[c] = turned[map.place[c]];
  return map;
}

ComponentMap image_component_map(const std::string& path,
                                 PixelType type,
                                 int components,
                                 Axes axes) {
  if (axes == Axes::lps && components == 6) {
    throw IoError(path, "",
                  "holds 6 components, whose order this format does not say; --axes lps turns "
                  "vectors (3) and tensors (9) of float32 or float64 here; leave it out, or use "
                  "NIfTI of intent code 1005");
  }
  return component_map(path, type, components, 0, axes);
}

void negate_samples(PixelType type, std::span<std::byte> samples) {
  const auto negated = []<class T>(T sample) { return T{0} - sample; };
  type == PixelType::float32 ? change_each<float>(samples, negated)
                             : change_each<double>(samples, negated);
}

void scale_samples(PixelType type, double factor, std::span<std::byte> samples) {
  const auto scaled = [factor]<class T>(T sample) { return static_cast<T>(0 + factor * sample); };
  type == PixelType::float32 ? change_each<float>(samples, scaled)
                             : change_each<double>(samples, scaled);
}

int itk_components(const Grid& grid) {
  constexpr double rounding = 1e-6;
  const bool is_axial_slice = grid.dims[2] == 1 && std::abs(grid.direction[2]) < rounding &&
                              std::abs(grid.direction[5]) < rounding;
  return is_axial_slice ? 2 : 3;
}

ComponentMap itk_field_map(const std::string& path,
                           PixelType type,
                           int components,
                           const Grid& grid,
                           bool has_form,
                           double unit) {
  if (components != 3 || is_integer(type)) {
    throw IoError(path, "",
                  "holds " + std::to_string(components) + " components of " + name_of(type) +
                      "; a displacement field for ITK has three of float32 or float64");
  }
  ComponentMap map{{0, 1, 2}, {has_form, has_form}, itk_components(grid)};
  map.scale = unit;
  return map;
}

}  // namespace tetwarp
