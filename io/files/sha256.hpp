/// @file sha256.hpp
/// The hash SHA-256 of files, as the program sha256sum prints it.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <tetwarp/io_export.hpp>

namespace tetwarp {

/// SHA-256 of bytes that come in parts. Source: FIPS 180-4.
class TETWARP_IO_EXPORT Sha256 {
 public:
  void add(std::span<const std::byte> bytes);

  /// The hash as 64 hexadecimal digits, once.
  std::string text();

 private:
  void take_block(const std::byte* block);

  std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<std::byte, 64> rest_{};  ///< bytes of a block that is not full
  std::uint64_t count_ = 0;           ///< bytes added
};

/// @throws IoError when the file cannot be read
TETWARP_IO_EXPORT std::string sha256_of_file(const std::string& path);

}  // namespace tetwarp
