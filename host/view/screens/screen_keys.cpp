/// @file screen_keys.cpp
/// A first line, then a name and a key in each.
#include "host/view/screens/screen_keys.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string_view>
#include <tetwarp/error.hpp>

namespace tetwarp::view {
namespace {
constexpr const char* first_line = "tetwarp screen keys 1";
constexpr std::size_t key_letters = 40;

/// Z85 (rfc.zeromq.org/spec/32): five letters are the digits of a number of 32 bits to the base 85.
constexpr std::string_view digits =
    "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ.-:+=^!/*?&<>()[]{}@%$#";
constexpr std::size_t group_letters = 5;

bool is_key(const std::string& text) {
  if (text.size() != key_letters) return false;
  std::uint64_t number = 0;
  for (std::size_t n = 0; n < key_letters; ++n) {
    const std::size_t digit = digits.find(text[n]);
    if (digit == std::string_view::npos) return false;
    number = (n % group_letters == 0 ? 0 : number * digits.size()) + digit;
    if (number > std::numeric_limits<std::uint32_t>::max()) return false;
  }
  return true;
}
}  // namespace

std::string master_text(const ScreenKeys& keys) {
  return std::string(first_line) + "\nmaster_public " + keys.master_public + "\nmaster_secret " +
         keys.master_secret + "\nscreen_public " + keys.screen_public + "\n";
}

std::string screen_text(const ScreenKeys& keys) {
  return std::string(first_line) + "\nmaster_public " + keys.master_public + "\nscreen_public " +
         keys.screen_public + "\nscreen_secret " + keys.screen_secret + "\n";
}

ScreenKeys read_screen_keys(const std::string& path, bool is_master) {
  std::ifstream file(path);
  std::string line, name, key;
  if (!file || !std::getline(file, line) || line != first_line) {
    throw IoError(path, "", "is no file that tetwarp view --make-keys wrote");
  }
  ScreenKeys keys;
  while (file >> name >> key) {
    std::string* const into = name == "master_public"   ? &keys.master_public
                              : name == "master_secret" ? &keys.master_secret
                              : name == "screen_public" ? &keys.screen_public
                              : name == "screen_secret" ? &keys.screen_secret
                                                        : nullptr;
    if (into == nullptr || !is_key(key)) {
      throw IoError(path, "", "has a wrong line '" + name.substr(0, 40) + "'");
    }
    *into = key;
  }
  const std::string& secret = is_master ? keys.master_secret : keys.screen_secret;
  if (keys.master_public.empty() || keys.screen_public.empty() || secret.empty()) {
    throw IoError(path, "",
                  is_master ? "lacks a key of the master; screens have the file NAME_screen.key"
                            : "lacks a key of the screens; the master has the file NAME.key");
  }
  return keys;
}

void check_no_file(const std::string& path) {
  std::error_code error;
  if (std::filesystem::symlink_status(path, error).type() !=
      std::filesystem::file_type::not_found) {
    throw IoError(path, "", "is there already; keys are not overwritten");
  }
}

bool is_loopback(const std::string& address) {
  for (const char* const start : {"tcp://127.", "tcp://localhost:", "tcp://[::1]:", "tcp://lo:"}) {
    if (address.starts_with(start)) return true;
  }
  return false;
}

}  // namespace tetwarp::view
