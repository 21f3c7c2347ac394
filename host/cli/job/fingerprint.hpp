/// @file fingerprint.hpp
/// A 64-bit hash of everything that determines an output file: --resume keeps a file with an equal
/// one.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/warp.hpp>

#include "host/base/number_hash.hpp"

namespace tetwarp::cli {

/// The size of an item is hashed before it, so that different sequences of items give different
/// hashes. Equal on all little-endian machines.
class Fingerprint {
 public:
  void add(std::span<const std::byte> bytes);
  void add(std::string_view text);

  template <class T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void add(T number) { add(std::as_bytes(std::span(&number, 1))); }

  template <class T, std::size_t count>
  void add(const std::array<T, count>& numbers) {
    add(std::as_bytes(std::span(numbers)));
  }

  template <class T>
  requires std::is_trivially_copyable_v<T>
  void add(const std::vector<T>& items) { add(std::as_bytes(std::span(items))); }

  void add(const Grid& grid);
  void add(const NiftiFacts& facts);

  /// The options that output values depend on; not the region.
  /// @pre  options.output_grid has a value
  void add(const WarpOptions& options);

  /// Name, type, grid and samples.
  void add(const Volume& volume);

  /// The same for samples in parts, in the order of memory: begin(), add_part(), end().
  void begin(const ArrayHeader& array, const Grid& grid);
  void add_part(std::span<const std::byte> bytes);
  void end();

  /// Sixteen hexadecimal digits.
  std::string text() const;

 private:
  std::uint64_t rest_ = 0;      ///< bytes of the parts so far that are not a whole word yet
  std::size_t rest_bytes_ = 0;  ///< fewer than eight
  WordHash<32> hash_;
};

}  // namespace tetwarp::cli
