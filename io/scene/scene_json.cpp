/// @file scene_json.cpp
/// Parses JSON, and reads values with the text of what was expected.
#include "io/scene/scene_json.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <tetwarp/error.hpp>

#include "host/base/nearest_word.hpp"
#include "host/base/scene_path.hpp"

namespace tetwarp {
namespace {
constexpr double largest_whole = 0x1p53;

/// A key as it can stand in a message of one line.
std::string shown(const std::string& key) {
  std::string text;
  for (const char c : key.substr(0, 40)) text += c >= ' ' && c <= '~' ? c : '?';
  return key.size() > 40 ? text + "..." : text;
}

std::string type_text(const SceneJson& json) {
  switch (json.type()) {
    case SceneJson::value_t::null:
      return "null";
    case SceneJson::value_t::object:
      return "an object";
    case SceneJson::value_t::array:
      return "a list of " + std::to_string(json.size());
    case SceneJson::value_t::string:
      return "text";
    case SceneJson::value_t::boolean:
      return json.get<bool>() ? "true" : "false";
    default:
      return "the number " + json.dump();
  }
}

/// "line L, column C" of a byte, from 1.
std::string position_text(const std::string& text, std::size_t byte) {
  const std::string before = text.substr(0, byte == 0 ? 0 : byte - 1);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t newline = before.rfind('\n');
  const std::size_t start = newline == std::string::npos ? 0 : newline + 1;
  return "line " + std::to_string(line) + ", column " + std::to_string(before.size() - start + 1);
}
}  // namespace

SceneJson parse_json(const std::string& text, const std::string& file) {
  std::vector<std::set<std::string>> keys;  // of the objects around the place that is read
  std::string repeated;
  const auto watch = [&](int, SceneJson::parse_event_t event, SceneJson& parsed) {
    if (event == SceneJson::parse_event_t::object_start) keys.emplace_back();
    if (event == SceneJson::parse_event_t::object_end) keys.pop_back();
    if (event == SceneJson::parse_event_t::key && repeated.empty()) {
      const std::string key = parsed.get<std::string>();
      if (!keys.back().insert(key).second) repeated = shown(key);
    }
    return true;
  };
  try {
    SceneJson json = SceneJson::parse(text, watch);
    if (!repeated.empty()) {
      throw IoError(file, repeated, "stands twice in one object, remove one of them");
    }
    return json;
  } catch (const SceneJson::parse_error& error) {
    throw IoError(file, position_text(text, error.byte),
                  "is not valid JSON; correct it (comments, NaN and trailing commas are not JSON)");
  } catch (const SceneJson::exception&) {
    throw IoError(file, "", "holds a number beyond 1e308; correct it");
  }
}

void SceneValue::fail(const std::string& problem) const {
  throw IoError(*file_, place_, problem);
}

void SceneValue::fail_type(const std::string& expected) const {
  fail("is " + type_text(*json_) + ", expected " + expected);
}

double SceneValue::number() const {
  if (!json_->is_number()) fail_type("a number");
  return json_->get<double>();
}

std::int64_t SceneValue::whole(std::int64_t low) const {
  const std::string expected = "a whole number from " + std::to_string(low);
  if (!json_->is_number()) fail_type(expected);
  const double value = json_->get<double>();
  if (value != std::floor(value) || value < static_cast<double>(low) || value > largest_whole) {
    fail_type(expected);
  }
  return static_cast<std::int64_t>(value);
}

void SceneValue::fail_word(const std::string& problem,
                           const std::vector<std::string>& words) const {
  std::string listed;
  for (const std::string& word : words) listed += (listed.empty() ? "" : ", ") + word;
  const std::string remedy = did_you_mean(text(), words);
  fail(problem + ", expected one of " + listed + (remedy.empty() ? "" : "; " + remedy));
}

bool SceneValue::boolean() const {
  if (!json_->is_boolean()) fail_type("true or false");
  return json_->get<bool>();
}

std::string SceneValue::text() const {
  if (!json_->is_string()) fail_type("text in quotes");
  const std::string& text = json_->get_ref<const std::string&>();
  if (std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < ' '; })) {
    fail("holds a control character, remove it");
  }
  return text;
}

std::vector<SceneValue> SceneValue::items(const std::string& expected) const {
  if (!json_->is_array()) fail_type(expected);
  std::vector<SceneValue> items;
  for (std::size_t n = 0; n < json_->size(); ++n) {
    items.emplace_back((*json_)[n], *file_, item_of(place_, n));
  }
  return items;
}

std::vector<SceneValue> SceneValue::list_of(std::size_t count) const {
  const std::string expected = "a list of " + std::to_string(count) + " numbers";
  if (!json_->is_array() || json_->size() != count) fail_type(expected);
  return items();
}

std::vector<double> SceneValue::numbers(std::size_t count) const {
  std::vector<double> numbers;
  for (const SceneValue& item : list_of(count)) numbers.push_back(item.number());
  return numbers;
}

SceneObject::SceneObject(const SceneValue& value, const std::string& expected) : value_(value) {
  if (!value.json_->is_object()) value.fail_type(expected);
}

std::optional<SceneValue> SceneObject::find(const std::string& key) {
  asked_.push_back(key);
  const auto found = value_.json_->find(key);
  if (found == value_.json_->end()) return std::nullopt;
  return SceneValue(*found, *value_.file_, key_of(value_.place_, key));
}

SceneValue SceneObject::get(const std::string& key, const std::string& expected) {
  if (const auto value = find(key)) return *value;
  throw IoError(*value_.file_, key_of(value_.place_, key), "is missing, expected " + expected);
}

std::optional<SceneValue> SceneObject::unread(const std::string& key) const {
  if (std::find(asked_.begin(), asked_.end(), key) != asked_.end()) return std::nullopt;
  return SceneObject(*this).find(key);
}

void SceneObject::read(const std::string& key, double& into) {
  if (const auto value = find(key)) into = value->number();
}
void SceneObject::read(const std::string& key, bool& into) {
  if (const auto value = find(key)) into = value->boolean();
}
void SceneObject::read(const std::string& key, Point3& into) {
  if (const auto value = find(key)) into = value->point();
}
void SceneObject::read(const std::string& key, std::optional<double>& into) {
  if (const auto value = find(key)) into = value->number();
}

void SceneObject::finish() const {
  for (const auto& [key, ignored] : value_.json_->items()) {
    if (std::find(asked_.begin(), asked_.end(), key) != asked_.end()) continue;
    std::string remedy = did_you_mean(key, asked_);
    if (remedy.empty()) {
      const std::set<std::string> keys(asked_.begin(), asked_.end());
      for (const std::string& known : keys) remedy += (remedy.empty() ? "" : ", ") + known;
      remedy = "the keys here are " + remedy;
    }
    throw IoError(*value_.file_, key_of(value_.place_, shown(key)), "is no known key; " + remedy);
  }
}

}  // namespace tetwarp
