/// @file mesh_child.cpp
/// Sends the mesh or the error of a reader through a pipe.
#include "io/import/mesh_child.hpp"

#include <cstdint>
#include <exception>
#include <new>
#include <tetwarp/error.hpp>

#include "io/files/memory.hpp"
#include "io/import/child_message.hpp"

namespace tetwarp {
namespace {
/// First byte of a message.
enum class Outcome : std::uint8_t { mesh, error };

void send_error(MessageWriter& message, const std::string& dataset, const std::string& problem) {
  message(Outcome::error);
  message(dataset);
  message(problem);
}

/// The text of an error without the names of file and dataset, which its constructor adds.
std::string problem_of(const IoError& error) {
  const std::string names = IoError(error.file(), error.dataset(), "").what();
  return std::string(error.what()).substr(names.size());
}

/// Runs in the child.
void send_mesh(ChildOutput& output, double memory, const std::function<ImportedMesh()>& read) {
  MessageWriter message(output);
  try {
    ImportedMesh mesh = read();
    message(Outcome::mesh);
    exchange_members(message, mesh);
  } catch (const IoError& error) {
    send_error(message, error.dataset(), problem_of(error));
  } catch (const std::bad_alloc&) {
    send_error(message, "",
               "cannot be read in " + bytes_text(memory) +
                   " of memory: damaged, or too large for this machine");
  } catch (const std::exception& error) {
    send_error(message, "", std::string("cannot be read: ") + error.what());
  }
}
}  // namespace

ImportedMesh read_mesh_in_child(const std::string& path,
                                const ChildLimits& limits,
                                const std::function<ImportedMesh()>& read) {
  std::string dataset, problem;
  try {
    ChildProcess child(limits,
                       [&](ChildOutput& output) { send_mesh(output, limits.memory, read); });
    MessageReader message(child, available_memory());
    Outcome outcome{};
    message(outcome);
    if (outcome == Outcome::mesh) {
      ImportedMesh mesh;
      exchange_members(message, mesh);
      return mesh;
    }
    message(dataset);
    message(problem);
  } catch (const ChildError& error) {
    throw IoError(path, "",
                  std::string("its reader ") + error.what() +
                      ": the file is damaged or uses what the library cannot read; write it again");
  }
  throw IoError(path, dataset, problem);
}

}  // namespace tetwarp
