/// @file extra_outputs.hpp
/// The arrays that `tetwarp warp --outputs` writes in addition to the warped ones, in one table.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>

#include <tetwarp/warp.hpp>

namespace tetwarp::cli {

/// An extra output: its word on the command line, its samples, and its member of WarpTarget.
struct ExtraOutput {
  const char* word;
  PixelType type;
  int components;
  void (*set)(WarpTarget& target, void* samples);  ///< samples fit the grid of the array

  /// Name of the array.
  std::string array() const { return std::string("tetwarp_") + word; }
};

/// The entry of a member of FieldTarget.
template <float* FieldTarget::*member>
constexpr ExtraOutput field_output(const char* word, int components) {
  return {word, PixelType::float32, components, [](WarpTarget& target, void* samples) {
            target.fields.*member = static_cast<float*>(samples);
          }};
}

inline constexpr std::array extra_outputs{
    ExtraOutput{"mask", PixelType::uint8, 1,
                [](WarpTarget& target, void* samples) {
                  target.mask = static_cast<std::uint8_t*>(samples);
                }},
    ExtraOutput{"tet", PixelType::int32, 1,
                [](WarpTarget& target, void* samples) {
                  target.owner = static_cast<std::int32_t*>(samples);
                }},
    field_output<&FieldTarget::displacement>("displacement", 3),
    field_output<&FieldTarget::jacobian>("jacobian", 1),
    field_output<&FieldTarget::gradient>("gradient", 9),
    field_output<&FieldTarget::strain>("strain", 6),
    field_output<&FieldTarget::forward>("forward", 3)};

/// The wanted ones, as indices in the table.
using ExtraChoice = std::set<std::size_t>;

/// Index of "forward", the only one on the grid of the source.
inline constexpr std::size_t forward_output = extra_outputs.size() - 1;

}  // namespace tetwarp::cli
