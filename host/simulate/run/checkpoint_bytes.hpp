/// @file checkpoint_bytes.hpp
/// Numbers as the bytes of a checkpoint, and their checksum.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace tetwarp {

/// Appends numbers and arrays of numbers, in the byte order of the machine.
class CheckpointWriter {
 public:
  template <class T>
  void add(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    append(&value, sizeof(T));
  }
  template <class T>
  void add(const std::vector<T>& list) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(static_cast<std::uint64_t>(list.size()));
    append(list.data(), list.size() * sizeof(T));
  }
  void add(const std::string& text) {
    add(static_cast<std::uint64_t>(text.size()));
    append(text.data(), text.size());
  }
  /// One byte, whether there is a value, and the value.
  template <class T>
  void add(const std::optional<T>& value) {
    add(static_cast<std::uint8_t>(value.has_value()));
    if (value) add(*value);
  }
  /// A list whose length does not follow from the scene, item by item.
  template <class T, class AddItem>
  void pass_list(const std::vector<T>& list, const AddItem& add_item) {
    add(static_cast<std::uint64_t>(list.size()));
    for (const T& item : list) add_item(*this, item);
  }
  template <class... Values>
  void operator()(const Values&... values) {
    (add(values), ...);
  }
  std::span<const std::byte> bytes() const { return bytes_; }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  void append(const void* data, std::size_t size);

  std::vector<std::byte> bytes_;
};

/// Reads them back. Its functions throw std::invalid_argument where the bytes end too early or a
/// list has another length than the one it replaces.
class CheckpointReader {
 public:
  explicit CheckpointReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <class T>
  void read(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::memcpy(&value, take(sizeof(T)), sizeof(T));
  }
  void read(bool& value);
  void read(std::string& text);
  /// @param list  of the length that the checkpoint must have
  template <class T>
  void read(std::vector<T>& list) {
    std::uint64_t size = 0;
    read(size);
    if (size != list.size()) {
      throw std::invalid_argument("checkpoint: a list has " + std::to_string(size) +
                                  " entries, the scene needs " + std::to_string(list.size()));
    }
    if (list.empty()) return;
    std::memcpy(list.data(), take(list.size() * sizeof(T)), list.size() * sizeof(T));
  }
  template <class T>
  void read(std::optional<T>& value) {
    std::uint8_t has_value = 0;
    read(has_value);
    value.reset();
    if (has_value != 0) read(value.emplace());
  }
  template <class T, class ReadItem>
  void pass_list(std::vector<T>& list, const ReadItem& read_item) {
    std::uint64_t size = 0;
    read(size);
    if (size > bytes_.size()) {  // an item has a byte at least
      throw std::invalid_argument("checkpoint: incomplete, a list of " + std::to_string(size) +
                                  " entries expected");
    }
    list.assign(static_cast<std::size_t>(size), T{});
    for (T& item : list) read_item(*this, item);
  }
  template <class... Values>
  void operator()(Values&... values) {
    (read(values), ...);
  }
  bool is_at_end() const { return bytes_.empty(); }

 private:
  const std::byte* take(std::size_t count);

  std::span<const std::byte> bytes_;
};

/// A hash of bytes, which a checkpoint ends with.
std::uint64_t checksum_of(std::span<const std::byte> bytes);

}  // namespace tetwarp
