/// @file scene_json.hpp
/// JSON values with their place in a document, so that every error names file, key and remedy.
#pragma once
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/io_export.hpp>
#include <tetwarp/names.hpp>
#include <tetwarp/volume.hpp>

namespace tetwarp {

using SceneJson = nlohmann::ordered_json;

/// Parses a document; an object with a key twice is an error as well.
/// @param file  for messages
TETWARP_IO_EXPORT SceneJson parse_json(const std::string& text, const std::string& file);

/// One value of a document.
class TETWARP_IO_EXPORT SceneValue {
 public:
  /// @param json  kept by the caller, as is `file`
  SceneValue(const SceneJson& json, const std::string& file, std::string place)
      : json_(&json), file_(&file), place_(std::move(place)) {}

  const std::string& place() const { return place_; }
  const std::string& file() const { return *file_; }
  bool is_null() const { return json_->is_null(); }
  bool is_text() const { return json_->is_string(); }
  bool is_list() const { return json_->is_array(); }

  /// @throws IoError  "FILE: PLACE: problem"
  [[noreturn]] void fail(const std::string& problem) const;
  /// @param expected  e.g. "a number"; the message also says what there is instead
  [[noreturn]] void fail_type(const std::string& expected) const;

  /// @param problem  e.g. "is no shape"; the message also lists the words that are known
  [[noreturn]] void fail_word(const std::string& problem,
                              const std::vector<std::string>& words) const;

  double number() const;
  /// A whole number from `low` to 2^53.
  std::int64_t whole(std::int64_t low) const;
  bool boolean() const;
  std::string text() const;
  /// A value of an enum by its word.
  template <class Enum>
  Enum word() const {
    const std::string word = text();
    for (const EnumName<Enum>& entry : names_of<Enum>()) {
      if (word == entry.name) return entry.value;
    }
    std::vector<std::string> words;
    for (const EnumName<Enum>& entry : names_of<Enum>()) words.emplace_back(entry.name);
    fail_word("is no known word", words);
  }

  /// The items of a list.
  std::vector<SceneValue> items(const std::string& expected = "a list") const;
  /// A list of `count` numbers.
  std::vector<double> numbers(std::size_t count) const;
  template <std::size_t count>
  std::array<double, count> array() const {
    const std::vector<double> values = numbers(count);
    std::array<double, count> array;
    for (std::size_t n = 0; n < count; ++n) array[n] = values[n];
    return array;
  }
  Point3 point() const { return array<3>(); }
  template <std::size_t count>
  std::array<std::int64_t, count> whole_array(std::int64_t low) const {
    const std::vector<SceneValue> values = list_of(count);
    std::array<std::int64_t, count> array;
    for (std::size_t n = 0; n < count; ++n) array[n] = values[n].whole(low);
    return array;
  }

 private:
  friend class SceneObject;
  std::vector<SceneValue> list_of(std::size_t count) const;

  const SceneJson* json_;
  const std::string* file_;
  std::string place_;
};

/// An object whose keys are read one by one. finish() complains about keys that were not.
class TETWARP_IO_EXPORT SceneObject {
 public:
  explicit SceneObject(const SceneValue& value, const std::string& expected = "an object {...}");

  const SceneValue& value() const { return value_; }
  [[noreturn]] void fail(const std::string& problem) const { value_.fail(problem); }

  /// The value of a key, or nothing.
  std::optional<SceneValue> find(const std::string& key);
  /// @param expected  what the key holds, for the message when it is missing
  SceneValue get(const std::string& key, const std::string& expected);
  /// The value of a key that was not asked for, or nothing.
  std::optional<SceneValue> unread(const std::string& key) const;

  // Each overwrites `into` if the key is there.
  void read(const std::string& key, double& into);
  void read(const std::string& key, bool& into);
  void read(const std::string& key, Point3& into);
  void read(const std::string& key, std::optional<double>& into);
  template <class Enum>
  requires std::is_enum_v<Enum>
  void read(const std::string& key, Enum& into) {
    if (const auto value = find(key)) into = value->word<Enum>();
  }

  /// @throws IoError  naming the first key that was not read, and the one that it resembles or all
  ///         keys that were asked for
  void finish() const;

 private:
  SceneValue value_;
  std::vector<std::string> asked_;
};

}  // namespace tetwarp
