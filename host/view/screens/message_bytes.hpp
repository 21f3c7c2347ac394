/// @file message_bytes.hpp
/// ByteWriter and ByteReader: values as bytes of a message between processes.
#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "host/base/value_stream.hpp"

namespace tetwarp::view {

static_assert(std::endian::native == std::endian::little, "messages are little-endian");

using Bytes = std::vector<std::byte>;

/// @throws std::invalid_argument  with the problem, unless it holds
inline void require(bool holds, const char* problem) {
  if (!holds) throw std::invalid_argument(problem);
}

/// Appends values.
class ByteWriter : public ValueWriter<ByteWriter> {
 public:
  void write_bytes(const void* data, std::size_t size) {
    const auto* const from = static_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), from, from + size);
  }
  Bytes take() { return std::move(bytes_); }

 private:
  Bytes bytes_;
};

/// Reads them in the same order. All calls throw std::invalid_argument where the message ends too
/// early.
class ByteReader : public ValueReader<ByteReader> {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : rest_(bytes) {}

  void read_bytes(void* data, std::size_t size) {
    require(size <= rest_.size(), "ends too early");
    std::memcpy(data, rest_.data(), size);
    rest_ = rest_.subspan(size);
  }
  void check_count(std::uint64_t count, std::size_t) const {
    require(count <= rest_.size(), "ends within a list");  // an item has a byte at least
  }
  void check_length(std::uint64_t, std::size_t) const {}
  [[noreturn]] void fail(const std::string& problem) const { throw std::invalid_argument(problem); }
  void end() const { require(rest_.empty(), "goes on after its end"); }

 private:
  std::span<const std::byte> rest_;
};

template <class Message>
Bytes bytes_of_values(const Message& message) {
  ByteWriter to;
  to(message);
  return to.take();
}

/// @throws std::invalid_argument  the bytes are not one such message
template <class Message>
Message read_values(std::span<const std::byte> bytes) {
  ByteReader from(bytes);
  Message message;
  from(message);
  from.end();
  return message;
}

}  // namespace tetwarp::view
