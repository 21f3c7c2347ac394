/// @file value_stream.hpp
/// Values as bytes in the byte order of the machine, read in the order in which they are written:
/// trivially copyable values, texts, lists, maps, optional values, variants, and records whose
/// members a function exchange_members(stream, record) passes to the stream.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace tetwarp {

/// Base class of Stream, which has write_bytes(const void*, std::size_t).
template <class Stream>
class ValueWriter {
 public:
  template <class... Values>
  void operator()(const Values&... values) {
    (write(values), ...);
  }
  /// A list of any length, each item by pass(stream, item).
  template <class T, class Pass>
  void pass_list(const std::vector<T>& list, const Pass& pass) {
    write(std::uint64_t{list.size()});
    for (const T& item : list) pass(self(), item);
  }

 private:
  Stream& self() { return static_cast<Stream&>(*this); }

  template <class T>
  requires std::is_trivially_copyable_v<T>
  void write(const T& value) { self().write_bytes(&value, sizeof value); }
  void write(const std::string& text) { write_items(text); }
  template <class T>
  void write(const std::vector<T>& list) {
    if constexpr (std::is_trivially_copyable_v<T>) {
      write_items(list);
    } else {
      pass_list(list, [](Stream& stream, const T& item) { stream(item); });
    }
  }
  template <class Key, class T>
  void write(const std::map<Key, T>& values) {
    write(std::uint64_t{values.size()});
    for (const auto& [key, value] : values) self()(key, value);
  }
  /// One byte, whether there is a value, and the value.
  template <class T>
  void write(const std::optional<T>& value) {
    write(static_cast<std::uint8_t>(value.has_value()));
    if (value) write(*value);
  }
  /// One byte, the number of the alternative, and its value.
  template <class... Kinds>
  void write(const std::variant<Kinds...>& value) {
    static_assert(sizeof...(Kinds) <= 256);
    write(static_cast<std::uint8_t>(value.index()));
    std::visit([this](const auto& kind) { write(kind); }, value);
  }
  template <class T>
  requires requires(Stream& stream, const T& record) { exchange_members(stream, record); }
  void write(const T& record) { exchange_members(self(), record); }

  template <class Items>
  void write_items(const Items& items) {
    write(std::uint64_t{items.size()});
    if (!items.empty()) self().write_bytes(items.data(), items.size() * sizeof items[0]);
  }
};

/// Base class of Stream, which trusts no byte: memory grows with the bytes that are there, never
/// with a count that is only claimed. Stream has
///
/// - read_bytes(void*, std::size_t);
/// - check_count(std::uint64_t count, std::size_t bytes): throws if so many items, each of so many
///   bytes in memory, cannot come;
/// - check_length(std::uint64_t count, std::size_t now): throws if a list of trivially copyable
///   items must not have that length in place of that of now;
/// - fail(std::string): throws.
template <class Stream>
class ValueReader {
 public:
  template <class... Values>
  void operator()(Values&... values) {
    (read(values), ...);
  }
  template <class T, class Pass>
  void pass_list(std::vector<T>& list, const Pass& pass) {
    list.clear();
    for (std::uint64_t left = count(sizeof(T)); left > 0; --left) pass(self(), list.emplace_back());
  }

 private:
  Stream& self() { return static_cast<Stream&>(*this); }

  template <class T>
  requires std::is_trivially_copyable_v<T>
  void read(T& value) { self().read_bytes(&value, sizeof value); }
  void read(bool& value) {
    std::uint8_t byte = 0;
    read(byte);
    if (byte > 1) self().fail("damaged, a flag is neither 0 nor 1");
    value = byte != 0;
  }
  void read(std::string& text) { read_items(text); }
  template <class T>
  void read(std::vector<T>& list) {
    if constexpr (std::is_trivially_copyable_v<T>) {
      read_items(list);
    } else {
      pass_list(list, [](Stream& stream, T& item) { stream(item); });
    }
  }
  template <class Key, class T>
  void read(std::map<Key, T>& values) {
    for (std::uint64_t left = count(sizeof(std::pair<Key, T>)); left > 0; --left) {
      Key key{};
      read(key);
      read(values[key]);
    }
  }
  template <class T>
  void read(std::optional<T>& value) {
    bool has_value = false;
    read(has_value);
    value.reset();
    if (has_value) read(value.emplace());
  }
  template <class... Kinds>
  void read(std::variant<Kinds...>& value) {
    std::uint8_t kind = 0;
    read(kind);
    read_kind(value, kind, std::index_sequence_for<Kinds...>());
  }
  template <class T>
  requires requires(Stream& stream, T& record) { exchange_members(stream, record); }
  void read(T& record) { exchange_members(self(), record); }

  template <class... Kinds, std::size_t... numbers>
  void read_kind(std::variant<Kinds...>& value, std::size_t kind, std::index_sequence<numbers...>) {
    const bool is_known =
        ((kind == numbers && (read(value.template emplace<numbers>()), true)) || ...);
    if (!is_known) self().fail("damaged, no alternative has number " + std::to_string(kind));
  }
  std::uint64_t count(std::size_t bytes) {
    std::uint64_t count = 0;
    read(count);
    self().check_count(count, bytes);
    return count;
  }
  template <class Items>
  void read_items(Items& items) {
    constexpr std::uint64_t first_part = 1 << 16;
    std::uint64_t all = 0;
    read(all);
    if constexpr (!std::is_same_v<Items, std::string>) self().check_length(all, items.size());
    self().check_count(all, sizeof items[0]);
    items.clear();
    for (std::uint64_t done = 0; done < all; done = items.size()) {
      items.resize(std::min(all, std::max(first_part, 2 * done)));
      self().read_bytes(items.data() + done, (items.size() - done) * sizeof items[0]);
    }
  }
};

}  // namespace tetwarp
