/// @file checkpoint_bytes.cpp
/// Appends and reads numbers and lists as bytes.
#include "host/simulate/run/checkpoint_bytes.hpp"

#include <algorithm>

#include "host/base/number_hash.hpp"

namespace tetwarp {

void CheckpointWriter::append(const void* data, std::size_t size) {
  if (size == 0) return;
  const std::size_t end = bytes_.size();
  bytes_.resize(end + size);
  std::memcpy(bytes_.data() + end, data, size);
}

void CheckpointReader::read(bool& value) {
  std::uint8_t byte = 0;
  read(byte);
  if (byte > 1) throw std::invalid_argument("checkpoint: damaged, a flag is neither 0 nor 1");
  value = byte != 0;
}

void CheckpointReader::read(std::string& text) {
  std::uint64_t size = 0;
  read(size);
  const std::byte* const bytes = take(static_cast<std::size_t>(size));
  text.assign(reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(size));
}

const std::byte* CheckpointReader::take(std::size_t count) {
  if (count > bytes_.size()) {
    throw std::invalid_argument("checkpoint: incomplete, " + std::to_string(count) +
                                " more bytes expected, got " + std::to_string(bytes_.size()));
  }
  const std::byte* begin = bytes_.data();
  bytes_ = bytes_.subspan(count);
  return begin;
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
