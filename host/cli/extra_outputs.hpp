/// @file extra_outputs.hpp
/// The arrays that `tetwarp warp --outputs` writes beside the warped ones, in one table.
#pragma once
#include <array>
#include <cstddef>
#include <set>
#include <string>

#include <tetwarp/warp.hpp>

namespace tetwarp::cli {

/// One of them.
struct ExtraOutput {
  const char* word;  ///< for --outputs
  PixelType type;
  int components;

  /// Name of the array.
  std::string array() const { return std::string("tetwarp_") + word; }
};

inline constexpr std::array extra_outputs{ExtraOutput{"mask", PixelType::uint8, 1},
                                          ExtraOutput{"tet", PixelType::int32, 1},
                                          ExtraOutput{"displacement", PixelType::float32, 3},
                                          ExtraOutput{"jacobian", PixelType::float32, 1},
                                          ExtraOutput{"gradient", PixelType::float32, 9},
                                          ExtraOutput{"strain", PixelType::float32, 6},
                                          ExtraOutput{"forward", PixelType::float32, 3}};

/// Those that are wanted, by their places in the table.
using ExtraChoice = std::set<std::size_t>;

/// The place in the table of an output that lies on the source's grid.
inline constexpr std::size_t forward_output = 6;

/// Has a step write output `number` to `samples`, which fit its grid.
void set_extra_output(WarpTarget& target, std::size_t number, void* samples);

}  // namespace tetwarp::cli
