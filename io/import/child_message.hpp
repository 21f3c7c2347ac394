/// @file child_message.hpp
/// Values that a child process sends as bytes. The reader trusts none of them: memory grows with
/// the bytes that have arrived, never with a count that is only claimed.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "io/import/child_process.hpp"

namespace tetwarp {

/// Sends values, each as MessageReader reads it. Errors stay in the stream, see std::ferror().
class MessageWriter {
 public:
  explicit MessageWriter(std::FILE* output) : output_(output) {}

  template <class T>
  requires std::is_trivially_copyable_v<T>
  void operator()(const T& value) { write(&value, sizeof value); }
  void operator()(const std::string& text) {
    (*this)(std::uint64_t{text.size()});
    write(text.data(), text.size());
  }
  template <class T>
  void operator()(const std::vector<T>& values) {
    (*this)(std::uint64_t{values.size()});
    if constexpr (std::is_trivially_copyable_v<T>) {
      write(values.data(), values.size() * sizeof(T));
    } else {
      for (const T& value : values) (*this)(value);
    }
  }
  template <class Key, class T>
  void operator()(const std::map<Key, T>& values) {
    (*this)(std::uint64_t{values.size()});
    for (const auto& [key, value] : values) {
      (*this)(key);
      (*this)(value);
    }
  }
  template <class T>
  requires(!std::is_trivially_copyable_v<T>) void operator()(const std::optional<T>& value) {
    (*this)(static_cast<std::uint8_t>(value.has_value()));
    if (value) (*this)(*value);
  }
  /// Any other type, by a function exchange_members(message, value).
  template <class T>
  requires requires(MessageWriter& writer, const T& value) { exchange_members(writer, value); }
  void operator()(const T& value) { exchange_members(*this, value); }

 private:
  void write(const void* bytes, std::size_t count) { std::fwrite(bytes, 1, count, output_); }

  std::FILE* output_;
};

/// Reads values from a source of bytes, such as a ChildProcess, with read(void*, std::size_t).
template <class Source>
class MessageReader {
 public:
  /// @param memory  [byte] that all values together may take
  MessageReader(Source& source, double memory) : source_(source), memory_(memory) {}

  template <class T>
  requires std::is_trivially_copyable_v<T>
  void operator()(T& value) { source_.read(&value, sizeof value); }
  void operator()(std::string& text) { read_elements(text); }
  template <class T>
  void operator()(std::vector<T>& values) {
    if constexpr (std::is_trivially_copyable_v<T>) {
      read_elements(values);
    } else {
      for (std::uint64_t left = count(sizeof(T)); left > 0; --left) {
        (*this)(values.emplace_back());
      }
    }
  }
  template <class Key, class T>
  void operator()(std::map<Key, T>& values) {
    for (std::uint64_t left = count(sizeof(std::pair<Key, T>)); left > 0; --left) {
      Key key{};
      (*this)(key);
      (*this)(values[key]);
    }
  }
  template <class T>
  requires(!std::is_trivially_copyable_v<T>) void operator()(std::optional<T>& value) {
    std::uint8_t has_value = 0;
    (*this)(has_value);
    if (has_value != 0) (*this)(value.emplace());
  }
  template <class T>
  requires requires(MessageReader& reader, T& value) { exchange_members(reader, value); }
  void operator()(T& value) { exchange_members(*this, value); }

 private:
  std::uint64_t count(std::size_t element_bytes) {
    std::uint64_t count = 0;
    (*this)(count);
    memory_ -= static_cast<double>(count) * static_cast<double>(element_bytes);
    if (memory_ < 0) throw ChildError("sent more than fits in memory");
    return count;
  }

  template <class Elements>
  void read_elements(Elements& elements) {
    constexpr std::uint64_t first_part = 1 << 16;
    const std::uint64_t all = count(sizeof elements[0]);
    for (std::uint64_t done = 0; done < all; done = elements.size()) {
      elements.resize(std::min(all, std::max(first_part, 2 * done)));
      source_.read(elements.data() + done, (elements.size() - done) * sizeof elements[0]);
    }
  }

  Source& source_;
  double memory_;
};

}  // namespace tetwarp
