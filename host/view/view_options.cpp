/// @file view_options.cpp
/// Options as words of a command line and back.
#include "host/view/view_options.hpp"

#include <algorithm>
#include <charconv>
#include <stdexcept>
#include <string_view>

namespace tetwarp::view {
namespace {

/// Calls `visit` with the name of each member and the member.
template <class Options, class Visit>
void visit_members(Options& of, const Visit& visit) {
  visit("scene_file", of.scene_file);
  visit("scene_name", of.scene_name);
  visit("backend", of.backend);
  visit("device", of.device);
  visit("threads", of.threads);
  visit("max_step_seconds", of.max_step_seconds);
  visit("untangle", of.untangle);
  visit("paused", of.paused);
  visit("fast", of.fast);
  visit("steps", of.steps);
  visit("width", of.width);
  visit("height", of.height);
  visit("camera", of.camera);
  visit("camera_name", of.camera_name);
  visit("preset", of.preset);
  visit("colors", of.colors);
  visit("voxels", of.voxels);
  visit("grab_radius", of.grab_radius);
  visit("grab_stiffness", of.grab_stiffness);
  visit("ball", of.ball);
  visit("fingers", of.fingers);
  visit("skin_stiffness", of.skin_stiffness);
  visit("screenshot", of.screenshot);
  visit("film", of.film);
  visit("record", of.record);
  visit("replay", of.replay);
  visit("checkpoint", of.checkpoint);
  visit("restart", of.restart);
  visit("screens", of.screens);
  visit("address", of.address);
  visit("key", of.key);
  visit("join", of.join);
  visit("screen", of.screen);
  visit("ends_with_master", of.ends_with_master);
  visit("timing", of.timing);
  visit("tracker", of.tracker);
  visit("devices", of.devices);
  visit("make_keys", of.make_keys);
}

void write(std::string& text, const std::string& value) {
  text += value;
}
void write(std::string& text, bool value) {
  text += value ? '1' : '0';
}
template <class Number>
void write_number(std::string& text, Number value) {
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}
void write(std::string& text, std::int64_t value) {
  write_number(text, value);
}
void write(std::string& text, double value) {
  write_number(text, value);
}
template <std::size_t count>
void write(std::string& text, const std::array<double, count>& values) {
  for (std::size_t n = 0; n < values.size(); ++n) {
    if (n > 0) text += ',';
    write(text, values[n]);
  }
}
template <class T>
void write(std::string& text, const std::optional<T>& value) {
  if (value) write(text, *value);
}

/// @returns false if the text is not a value of this type
bool read(std::string_view text, std::string& value) {
  value = text;
  return true;
}
bool read(std::string_view text, bool& value) {
  value = text == "1";
  return value || text == "0";
}
template <class Number>
bool read_number(std::string_view text, Number& value) {
  const char* const end = text.data() + text.size();
  const auto [past, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && past == end;
}
bool read(std::string_view text, std::int64_t& value) {
  return read_number(text, value);
}
bool read(std::string_view text, double& value) {
  return read_number(text, value);
}
template <std::size_t count>
bool read(std::string_view text, std::array<double, count>& values) {
  for (double& value : values) {
    const std::size_t comma = std::min(text.find(','), text.size());
    if (!read(text.substr(0, comma), value)) return false;
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return text.empty();
}
template <class T>
bool read(std::string_view text, std::optional<T>& value) {
  return read(text, value.emplace());
}

}  // namespace

std::vector<std::string> ViewOptions::outputs() const {
  std::vector<std::string> files{screenshot, film, record, checkpoint};
  std::erase(files, "");
  return files;
}

std::string ViewOptions::scene_words() const {
  std::string words = scene();
  if (ball) words += " --ball ";
  write(words, ball);
  if (!restart.empty()) words += " --restart " + restart;
  if (fingers) {
    words += " --fingers ";
    write(words, fingers);
    words += " --skin-stiffness ";
    write(words, skin_stiffness);
  }
  return words;
}

std::vector<std::string> words_of(const ViewOptions& options) {
  std::vector<std::string> defaults, words;
  const auto list = [](std::vector<std::string>& all) {
    return [&all](const char* name, const auto& member) {
      std::string& word = all.emplace_back(name) += '=';
      write(word, member);
    };
  };
  const ViewOptions none;
  visit_members(none, list(defaults));
  visit_members(options, list(words));
  std::size_t n = 0;
  std::erase_if(words, [&](const std::string& word) { return word == defaults[n++]; });
  return words;
}

ViewOptions options_of(const std::vector<std::string>& words) {
  ViewOptions options;
  for (const std::string& word : words) {
    const std::size_t sign = std::min(word.find('='), word.size());
    const std::string_view name = std::string_view(word).substr(0, sign);
    const std::string_view value = std::string_view(word).substr(std::min(sign + 1, word.size()));
    bool is_read = false;
    visit_members(options, [&](const char* member_name, auto& member) {
      if (name == member_name) is_read = read(value, member);
    });
    if (!is_read) {
      throw std::invalid_argument("'" + word +
                                  "': not a word of tetwarp view, which starts this program");
    }
  }
  return options;
}

}  // namespace tetwarp::view
