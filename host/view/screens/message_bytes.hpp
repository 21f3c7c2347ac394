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
#include <type_traits>
#include <utility>
#include <vector>

namespace tetwarp::view {

static_assert(std::endian::native == std::endian::little, "messages are little-endian");

using Bytes = std::vector<std::byte>;

/// @throws std::invalid_argument  with the problem, unless it holds
inline void require(bool holds, const char* problem) {
  if (!holds) throw std::invalid_argument(problem);
}

/// Appends numbers as they are in memory, and lists and texts behind their size.
class ByteWriter {
 public:
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void add(const T& value) {
    const auto* const from = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), from, from + sizeof value);
  }
  template <class T>
  void add_list(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(static_cast<std::uint64_t>(values.size()));
    const auto* const from = reinterpret_cast<const std::byte*>(values.data());
    bytes_.insert(bytes_.end(), from, from + values.size() * sizeof(T));
  }
  void add_text(const std::string& text) { add_list(std::vector<char>(text.begin(), text.end())); }

  Bytes take() { return std::move(bytes_); }

 private:
  Bytes bytes_;
};

/// Reads what a ByteWriter wrote, in the same order. Allocates no more than the message has.
/// All calls throw std::invalid_argument where the message ends too early.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <class T>
  T get() {
    static_assert(std::is_trivially_copyable_v<T>);
    T value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  /// Only 0 and 1 are truth values.
  bool get_bool() {
    const auto value = get<std::uint8_t>();
    if (value > 1) throw std::invalid_argument("not a truth value");
    return value == 1;
  }
  /// @returns how many items of at least `bytes` each follow
  std::size_t get_count(std::size_t bytes) {
    const auto count = get<std::uint64_t>();
    if (count > rest_.size() / bytes) throw std::invalid_argument("ends within a list");
    return static_cast<std::size_t>(count);
  }
  template <class T>
  std::vector<T> get_list() {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<T> values(get_count(sizeof(T)));
    const auto from = take(values.size() * sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), from.data(), from.size());
    return values;
  }
  std::string get_text() {
    const std::vector<char> text = get_list<char>();
    return {text.begin(), text.end()};
  }
  std::span<const std::byte> rest() const { return rest_; }
  void end() const {
    if (!rest_.empty()) throw std::invalid_argument("goes on after its end");
  }

 private:
  std::span<const std::byte> take(std::size_t count) {
    if (count > rest_.size()) throw std::invalid_argument("ends too early");
    const auto taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }

  std::span<const std::byte> rest_;
};

}  // namespace tetwarp::view
