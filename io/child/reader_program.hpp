/// @file reader_program.hpp
/// Starts the program tetwarp-read and takes its answer.
#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <tetwarp/missing_library.hpp>

#include "io/child/child_message.hpp"
#include "io/child/child_process.hpp"
#include "io/files/memory.hpp"

namespace tetwarp {

struct ChildLimits {
  double seconds;  ///< from the start to the last byte of the result
  double memory;   ///< [byte] that the program may allocate
};

/// Far above the time and memory that any sound file needs, also on a busy machine.
/// @param time  [s] that it may take; 0: by the size of the file
ChildLimits limits_for(const std::string& path, double time = 0);

/// First value of a message: the result follows, name of a dataset and text of an error, or name of
/// a library and text of a MissingLibrary.
enum class ChildOutcome : std::uint8_t { result, error, missing_library };

/// Path of the program: TETWARP_READER in the environment, else it is searched beside this library
/// or program and where both are installed. @throws IoError  of `path`, when it is not found
std::string find_reader(const std::string& path);

/// Reads an outcome. @throws IoError  the one that the program has sent
template <class Message>
void expect_result(const std::string& path, Message& message) {
  ChildOutcome outcome{};
  message(outcome);
  if (outcome == ChildOutcome::result) return;
  std::string name, problem;
  message(name, problem);
  if (outcome == ChildOutcome::missing_library) throw MissingLibrary(path, name, problem);
  throw IoError(path, name, problem);
}

/// Starts the program with words and has `receive` read its result.
/// @throws IoError of the reader; when the program is not found, crashes or exceeds its limits
/// @throws std::runtime_error when it cannot be started or lacks a library
template <class Receive>
void run_reader(const std::string& path,
                std::vector<std::string> words,
                const ChildLimits& limits,
                const Receive& receive) {
  words.insert(words.begin(), {find_reader(path), path, std::to_string(limits.memory)});
  try {
    ChildProcess child(std::move(words), limits.seconds);
    MessageReader message(child, available_memory());
    expect_result(path, message);
    receive(message);
  } catch (const ChildError& error) {
    throw IoError(path, "",
                  std::string("its reader ") + error.what() +
                      ": the file is damaged or uses what the library cannot read; write it again");
  }
}

}  // namespace tetwarp
