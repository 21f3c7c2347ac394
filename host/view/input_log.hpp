/// @file input_log.hpp
/// What a user did to a simulation, by step, as a file.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/simulate.hpp>

namespace tetwarp::view {

enum class InputKind {
  grab,     ///< holds a body at a point
  move,     ///< the held point is pulled to another place
  release,  ///< lets go
  restart,  ///< the state of the start
  carry,    ///< a scripted body goes to another place
  limit     ///< the next step ends at counts
};

/// Acts before a step.
struct InputEvent {
  std::int64_t tick = 0;  ///< steps made before it; goes on counting after a restart
  InputKind kind = InputKind::release;
  PointHandle handle = {};  ///< of a grab; its name is not kept. Of a carry: the body alone
  Point3 displacement{};    ///< of a move or carry: of the anchors or the body from where they
                            ///< started [m]
  StepLimit limit = {};     ///< of a limit

  bool operator==(const InputEvent&) const = default;
};

struct InputLog {
  std::string scene;               ///< ViewOptions::scene_words(), for messages
  std::uint64_t start = 0;         ///< as start_hash()
  std::vector<InputEvent> events;  ///< ticks do not fall
  std::int64_t ticks = 0;          ///< steps made in all
};

/// A hash of the state of a start, which is equal if scene, tools and state are.
/// @param checkpoint  of the simulation before its first step
std::uint64_t start_hash(std::span<const std::byte> checkpoint);

/// The lines of a file; numbers keep all their bits.
std::string text_of(const InputLog& log);

/// @throws IoError  in one line naming the file and the line
InputLog read_input_log(const std::string& path);

}  // namespace tetwarp::view
