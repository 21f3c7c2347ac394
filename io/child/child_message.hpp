/// @file child_message.hpp
/// Values that a child process sends as bytes.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>

#include "host/base/value_stream.hpp"
#include "io/child/child_process.hpp"

namespace tetwarp {

/// Sends values, each as MessageReader reads it. Errors stay in the stream, see std::ferror().
class MessageWriter : public ValueWriter<MessageWriter> {
 public:
  explicit MessageWriter(std::FILE* output) : output_(output) {}

  void write_bytes(const void* bytes, std::size_t count) { std::fwrite(bytes, 1, count, output_); }

 private:
  std::FILE* output_;
};

/// Reads values from a source of bytes, such as a ChildProcess, with read(void*, std::size_t).
/// Throws ChildError.
template <class Source>
class MessageReader : public ValueReader<MessageReader<Source>> {
 public:
  /// @param memory  [byte] that all values together may take
  MessageReader(Source& source, double memory) : source_(source), memory_(memory) {}

  void read_bytes(void* bytes, std::size_t count) { source_.read(bytes, count); }
  void check_count(std::uint64_t count, std::size_t bytes) {
    memory_ -= static_cast<double>(count) * static_cast<double>(bytes);
    if (memory_ < 0) fail("sent more than fits in memory");
  }
  void check_length(std::uint64_t, std::size_t) const {}
  [[noreturn]] void fail(const std::string& problem) const { throw ChildError(problem); }

 private:
  Source& source_;
  double memory_;
};

}  // namespace tetwarp
