/// @file text_file.cpp
/// Opens a file and reads it to its end.
#include "io/files/text_file.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>
#include <tetwarp/error.hpp>

namespace tetwarp {
namespace {
std::ifstream opened(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw IoError(path, "", "is a folder");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw IoError(path, "", std::string("cannot be opened: ") + std::strerror(errno));
  return file;
}
}  // namespace

void check_readable(const std::string& path) {
  opened(path);
}

std::string read_text(const std::string& path) {
  const std::ifstream file = opened(path);
  std::ostringstream text;
  text << file.rdbuf();
  if (text.bad()) throw IoError(path, "", std::string("cannot be read: ") + std::strerror(errno));
  return text.str();
}

}  // namespace tetwarp
