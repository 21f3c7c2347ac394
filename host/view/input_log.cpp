/// @file input_log.cpp
/// One line per event: its tick, a word and numbers.
#include "host/view/input_log.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <tetwarp/error.hpp>

#include "host/base/number_hash.hpp"

namespace tetwarp::view {
namespace {
constexpr const char* first_line = "tetwarp input 2";
constexpr const char* start_word = "start";
constexpr const char* const words[] = {"grab", "move", "release", "restart", "carry", "limit"};

template <class Number>
std::string number(Number value) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

std::string numbers(const Point3& point) {
  return " " + number(point[0]) + " " + number(point[1]) + " " + number(point[2]);
}

/// Reads the words of one line.
class LineReader {
 public:
  explicit LineReader(const std::string& line) : words_(line) {}

  std::string word() {
    std::string next;
    if (!(words_ >> next)) throw std::invalid_argument("ends too early");
    return next;
  }
  template <class Number>
  Number number() {
    const std::string text = word();
    Number value{};
    const char* const end = text.data() + text.size();
    const auto [past, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || past != end || !std::isfinite(static_cast<double>(value))) {
      throw std::invalid_argument("'" + text + "' is not a number");
    }
    return value;
  }
  Point3 point() {
    Point3 point{};
    for (double& part : point) part = number<double>();
    return point;
  }
  void end() {
    std::string rest;
    if (words_ >> rest) throw std::invalid_argument("'" + rest + "' is one word too many");
  }

 private:
  std::istringstream words_;
};

InputEvent event_of(LineReader& line, std::int64_t tick, const std::string& word) {
  InputEvent event;
  event.tick = tick;
  std::size_t kind = 0;
  while (kind < std::size(words) && word != words[kind]) ++kind;
  if (kind == std::size(words)) {
    throw std::invalid_argument("'" + word +
                                "' is not grab, move, release, restart, carry, limit or end");
  }
  event.kind = static_cast<InputKind>(kind);
  if (event.kind == InputKind::grab) {
    event.handle.body = line.word();
    event.handle.center = line.point();
    event.handle.radius = line.number<double>();
    event.handle.stiffness = line.number<double>();
    event.handle.damping = line.number<double>();
  } else if (event.kind == InputKind::move) {
    event.displacement = line.point();
  } else if (event.kind == InputKind::carry) {
    event.handle.body = line.word();
    event.displacement = line.point();
  } else if (event.kind == InputKind::limit) {
    event.limit.checks = line.number<std::int64_t>();
    event.limit.divisions = line.number<std::int64_t>();
  }
  return event;
}

void read_start(const std::string& text, InputLog& log) {
  LineReader line(text);
  if (line.word() != start_word) throw std::invalid_argument("is not start and a number");
  log.start = line.number<std::uint64_t>();
  line.end();
}

/// @returns whether it was the last line
bool add_line(const std::string& text, InputLog& log) {
  LineReader line(text);
  const auto tick = line.number<std::int64_t>();
  if (tick < (log.events.empty() ? 0 : log.events.back().tick)) {
    throw std::invalid_argument("its step is before that of the line above");
  }
  const std::string word = line.word();
  const bool is_last = word == "end";
  if (is_last) {
    log.ticks = tick;
  } else {
    log.events.push_back(event_of(line, tick, word));
  }
  line.end();
  return is_last;
}
}  // namespace

std::uint64_t start_hash(std::span<const std::byte> checkpoint) {
  NumberHash hash;
  for (std::size_t n = 0; n < checkpoint.size(); n += sizeof(std::uint64_t)) {
    std::uint64_t word = 0;
    std::memcpy(&word, checkpoint.data() + n, std::min(sizeof word, checkpoint.size() - n));
    hash.add_bits(word);
  }
  hash.add_bits(checkpoint.size());
  return hash.value();
}

std::string text_of(const InputLog& log) {
  std::string text = std::string(first_line) + "\n" + log.scene + "\n";
  text += std::string(start_word) + " " + number(log.start) + "\n";
  for (const InputEvent& event : log.events) {
    text += number(event.tick) + " " + words[static_cast<std::size_t>(event.kind)];
    if (event.kind == InputKind::grab) {
      const PointHandle& handle = event.handle;
      text += " " + handle.body + numbers(handle.center) + " " + number(handle.radius) + " " +
              number(handle.stiffness) + " " + number(handle.damping);
    } else if (event.kind == InputKind::move) {
      text += numbers(event.displacement);
    } else if (event.kind == InputKind::carry) {
      text += " " + event.handle.body + numbers(event.displacement);
    } else if (event.kind == InputKind::limit) {
      text += " " + number(event.limit.checks) + " " + number(event.limit.divisions);
    }
    text += "\n";
  }
  return text + number(log.ticks) + " end\n";
}

InputLog read_input_log(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  if (!file || !std::getline(file, line) || line != first_line) {
    throw IoError(path, "", "is not a file that tetwarp view --record wrote");
  }
  InputLog log;
  std::getline(file, log.scene);
  for (int n = 3; std::getline(file, line); ++n) {
    try {
      if (n == 3) {
        read_start(line, log);
      } else if (add_line(line, log)) {
        return log;
      }
    } catch (const std::invalid_argument& error) {
      throw IoError(path, "", "line " + std::to_string(n) + " " + error.what());
    }
  }
  throw IoError(path, "", "is incomplete: its last line, end, is missing");
}

}  // namespace tetwarp::view
