/// @file checkpoint_bytes.cpp
/// Appends bytes, and reads them with checks.
#include "host/simulate/state/checkpoint_bytes.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "host/base/number_hash.hpp"

namespace tetwarp {

void CheckpointWriter::write_bytes(const void* data, std::size_t size) {
  const std::size_t end = bytes_.size();
  bytes_.resize(end + size);
  std::memcpy(bytes_.data() + end, data, size);
}

void CheckpointReader::read_bytes(void* data, std::size_t size) {
  if (size > bytes_.size()) {
    fail("incomplete, " + std::to_string(size) + " more bytes expected, got " +
         std::to_string(bytes_.size()));
  }
  std::memcpy(data, bytes_.data(), size);
  bytes_ = bytes_.subspan(size);
}

void CheckpointReader::check_count(std::uint64_t count, std::size_t) const {
  if (count > bytes_.size()) {  // an item has a byte at least
    fail("incomplete, a list of " + std::to_string(count) + " entries expected");
  }
}

void CheckpointReader::check_length(std::uint64_t count, std::size_t now) const {
  if (count != now) {
    fail("a list has " + std::to_string(count) + " entries, the scene needs " +
         std::to_string(now));
  }
}

void CheckpointReader::fail(const std::string& problem) const {
  throw std::invalid_argument("checkpoint: " + problem);
}

std::uint64_t checksum_of(std::span<const std::byte> bytes) {
  NumberHash hash;
  for (; !bytes.empty(); bytes = bytes.subspan(std::min<std::size_t>(8, bytes.size()))) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, bytes.data(), std::min<std::size_t>(8, bytes.size()));
    hash.add_bits(bits);
  }
  return hash.value();
}

}  // namespace tetwarp
