/// @file extra_outputs.hpp
/// Table of the arrays that a step can write in addition to the volumes: mask, owners and fields.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include <tetwarp/warp.hpp>

namespace tetwarp {

/// One array of WarpTarget or of its FieldTarget.
struct ExtraOutput {
  const char* word;  ///< for `tetwarp warp --outputs`
  PixelType type;
  int components;
  void* (*get)(const WarpTarget&);        ///< null: not written
  void (*set)(WarpTarget&, void* array);  ///< the array has the table's type and components

  /// Name of the array in files.
  std::string array() const { return std::string("tetwarp_") + word; }
  std::int64_t voxel_bytes() const { return components * static_cast<std::int64_t>(size_of(type)); }
};

/// An entry whose array is a member of WarpTarget.
template <class Sample, Sample* WarpTarget::*member>
constexpr ExtraOutput target_output(const char* word, int components) {
  return {word, pixel_type_of<Sample>(), components,
          [](const WarpTarget& target) -> void* { return target.*member; },
          [](WarpTarget& target, void* array) { target.*member = static_cast<Sample*>(array); }};
}

/// An entry whose array is a member of FieldTarget.
template <float* FieldTarget::*member>
constexpr ExtraOutput field_output(const char* word, int components) {
  return {
      word, PixelType::float32, components,
      [](const WarpTarget& target) -> void* { return target.fields.*member; },
      [](WarpTarget& target, void* array) { target.fields.*member = static_cast<float*>(array); }};
}

inline constexpr std::array extra_outputs{
    target_output<std::uint8_t, &WarpTarget::mask>("mask", 1),
    target_output<std::int32_t, &WarpTarget::owner>("tet", 1),
    field_output<&FieldTarget::displacement>("displacement", 3),
    field_output<&FieldTarget::jacobian>("jacobian", 1),
    field_output<&FieldTarget::gradient>("gradient", 9),
    field_output<&FieldTarget::strain>("strain", 6),
    field_output<&FieldTarget::forward>("forward", 3)};

/// Place of a word in the table; in a constant expression an unknown word does not compile.
constexpr std::size_t extra_place(std::string_view word) {
  for (std::size_t e = 0; e < extra_outputs.size(); ++e) {
    if (extra_outputs[e].word == word) return e;
  }
  throw std::invalid_argument("no such output");
}

inline constexpr std::size_t owner_output = extra_place("tet");
inline constexpr std::size_t forward_output = extra_place("forward");  ///< on the source's grid

}  // namespace tetwarp
