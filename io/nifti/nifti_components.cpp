/// @file nifti_components.cpp
/// Turns components between the order of files and that of volumes.
#include "io/nifti/nifti_components.hpp"

#include <nifti1.h>

#include <cstring>
#include <tetwarp/error.hpp>

namespace tetwarp {
namespace {
/// NIfTI stores the lower triangle row by row, xx xy yy xz yz zz; VTK's order is xx yy zz xy yz xz.
constexpr std::array<std::size_t, 9> vtk_place_of_symmatrix = {0, 3, 1, 5, 4, 2, 6, 7, 8};

template <class T>
void negate(std::span<std::byte> samples) {
  for (std::size_t at = 0; at < samples.size(); at += sizeof(T)) {
    T sample;
    std::memcpy(&sample, samples.data() + at, sizeof sample);
    sample = T{0} - sample;
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
  ComponentMap map{{0, 1, 2, 3, 4, 5, 6, 7, 8}, {}};
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

void negate_samples(PixelType type, std::span<std::byte> samples) {
  type == PixelType::float32 ? negate<float>(samples) : negate<double>(samples);
}

}  // namespace tetwarp
