/// @file checkpoint_bytes.hpp
/// Numbers as the bytes of a checkpoint, and their checksum.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/base/value_stream.hpp"

namespace tetwarp {

/// Appends values to bytes in memory.
class CheckpointWriter : public ValueWriter<CheckpointWriter> {
 public:
  void write_bytes(const void* data, std::size_t size);

  std::span<const std::byte> bytes() const { return bytes_; }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

/// Reads them back. Lists of numbers keep their lengths, which follow from the scene; other lists
/// are read by pass_list(). Throws std::invalid_argument where the bytes end too early or a list
/// has another length than the one it replaces.
class CheckpointReader : public ValueReader<CheckpointReader> {
 public:
  explicit CheckpointReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  void read_bytes(void* data, std::size_t size);
  void check_count(std::uint64_t count, std::size_t) const;
  void check_length(std::uint64_t count, std::size_t now) const;
  [[noreturn]] void fail(const std::string& problem) const;
  bool is_at_end() const { return bytes_.empty(); }

 private:
  std::span<const std::byte> bytes_;
};

/// A hash of bytes, which a checkpoint ends with.
std::uint64_t checksum_of(std::span<const std::byte> bytes);

}  // namespace tetwarp
