/// @file room_pvx.cpp
/// Elements and attributes, by expat.
#include "host/view/link/room_pvx.hpp"

#include <expat.h>

#include <array>
#include <charconv>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <stdexcept>
#include <tetwarp/error.hpp>

namespace tetwarp::view {
namespace {
using Attributes = std::map<std::string, std::string>;

std::vector<double> numbers_of(const std::string& text, const std::string& what) {
  std::istringstream words(text);
  std::vector<double> numbers;
  for (double number = 0; words >> number;) numbers.push_back(number);
  if (!words.eof() || numbers.empty())
    throw std::invalid_argument(what + " '" + text + "' is no list of numbers");
  return numbers;
}

Point3 corner_of(const Attributes& of, const std::string& key) {
  const auto found = of.find(key);
  if (found == of.end()) throw std::invalid_argument("Machine: " + key + " is missing");
  const std::vector<double> numbers = numbers_of(found->second, key);
  if (numbers.size() != 3) throw std::invalid_argument(key + ": expected three numbers");
  return {numbers[0], numbers[1], numbers[2]};
}

/// WxH+X+Y or WxH.
std::array<std::int32_t, 4> window_of(const std::string& text) {
  std::array<std::int32_t, 4> parts{};  // W H X Y
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t n = 0; n < 4 && at < end; ++n) {
    if (n > 0 && *at == (n == 1 ? 'x' : '+')) ++at;
    const auto [past, error] = std::from_chars(at, end, parts[n]);
    if (error != std::errc()) throw std::invalid_argument("Geometry '" + text + "' is not WxH+X+Y");
    at = past;
  }
  return {parts[2], parts[3], parts[0], parts[1]};
}

/// Reads what expat finds; the first problem is kept and ends it.
class PvxReader {
 public:
  explicit PvxReader(XML_Parser parser) : parser_(parser) {}

  void begin(const std::string& element, Attributes of) {
    if (!problem_.empty()) return;
    try {
      read(element, of);
    } catch (const std::invalid_argument& error) {
      problem_ = error.what();
      XML_StopParser(parser_, XML_FALSE);
    }
  }
  const std::string& problem() const { return problem_; }
  Room take() {
    for (const std::string& key : ignored_) room_.notes.push_back(key + " has no effect");
    return std::move(room_);
  }

 private:
  void read(const std::string& element, Attributes& of) {
    if (element == "pvx") return;
    if (element == "Process") return ignore_all(element, of, {"Type"});
    if (element == "EyeSeparation") {
      room_.eye_separation = numbers_of(of["Value"], element)[0];
      return;
    }
    if (element == "UseOffAxisProjection") return;  // always done
    if (element == "Option") return read_option(of);
    if (element == "Machine") return read_machine(of);
    ignored_.insert(element);
  }

  void read_option(Attributes& of) {
    const bool is_on = of["Value"] == "1" || of["Value"] == "true";
    if (of["Name"] == "FullScreen") {
      is_fullscreen_ = is_on;
    } else if (of["Name"] == "ShowBorders") {
      has_border_ = is_on;
    } else {
      ignored_.insert("Option " + of["Name"]);
    }
  }

  void read_machine(Attributes& of) {
    Screen screen;
    screen.name = "screen" + std::to_string(room_.screens.size());
    screen.lower_left = corner_of(of, "LowerLeft");
    screen.lower_right = corner_of(of, "LowerRight");
    screen.upper_right = corner_of(of, "UpperRight");
    screen.is_fullscreen = of.contains("FullScreen") ? of["FullScreen"] == "1" : is_fullscreen_;
    screen.has_border = of.contains("ShowBorders") ? of["ShowBorders"] == "1" : has_border_;
    if (of.contains("Geometry")) screen.window = window_of(of["Geometry"]);
    const std::string environment = of["Environment"];
    if (environment.starts_with("DISPLAY=")) {
      screen.display = environment.substr(8);
    } else if (!environment.empty()) {
      ignored_.insert("Environment " + environment);
    }
    const std::string host = of["Name"];
    if (host != "localhost" && host != "127.0.0.1") screen.host = host;
    screen.stereo = stereo_of(of["StereoType"]);
    room_.screens.push_back(screen);
    ignore_all("Machine", of,
               {"Name", "Environment", "LowerLeft", "LowerRight", "UpperRight", "Geometry",
                "FullScreen", "ShowBorders", "StereoType"});
  }

  Stereo stereo_of(const std::string& type) {
    static const std::map<std::string, Stereo> kinds{
        {"", Stereo::none},
        {"Crystal Eyes", Stereo::quad_buffer},
        {"Anaglyph", Stereo::anaglyph},
        {"Red-Blue", Stereo::anaglyph},
        {"SplitViewportHorizontal", Stereo::side_by_side},
        {"Left", Stereo::left},
        {"Right", Stereo::right}};
    const auto found = kinds.find(type);
    if (found != kinds.end()) return found->second;
    ignored_.insert("StereoType " + type);
    return Stereo::none;
  }

  void ignore_all(const std::string& element,
                  const Attributes& of,
                  const std::set<std::string>& known) {
    for (const auto& [key, value] : of) {
      if (!known.contains(key)) ignored_.insert(element + " " + key);
    }
  }

  XML_Parser parser_;
  Room room_;
  bool is_fullscreen_ = false, has_border_ = false;
  std::set<std::string> ignored_;
  std::string problem_;
};

void on_element(void* reader, const char* name, const char** attributes) {
  Attributes of;
  for (; *attributes != nullptr; attributes += 2) of[attributes[0]] = attributes[1];
  static_cast<PvxReader*>(reader)->begin(name, std::move(of));
}
}  // namespace

Room parse_pvx(const std::string& text, const std::string& name) {
  const std::unique_ptr<XML_ParserStruct, void (*)(XML_Parser)> parser(XML_ParserCreate(nullptr),
                                                                       XML_ParserFree);
  PvxReader reader(parser.get());
  XML_SetUserData(parser.get(), &reader);
  XML_SetStartElementHandler(parser.get(), on_element);
  const bool is_read = XML_Parse(parser.get(), text.data(), static_cast<int>(text.size()),
                                 XML_TRUE) == XML_STATUS_OK;
  try {
    if (!reader.problem().empty()) throw std::invalid_argument(reader.problem());
    if (!is_read) throw std::invalid_argument(XML_ErrorString(XML_GetErrorCode(parser.get())));
    Room room = reader.take();
    check_room(room);
    return room;
  } catch (const std::invalid_argument& error) {
    const auto line = XML_GetCurrentLineNumber(parser.get());
    throw IoError(name, "", "line " + std::to_string(line) + ": " + error.what());
  }
}

}  // namespace tetwarp::view
