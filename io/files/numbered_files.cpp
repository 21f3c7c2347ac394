/// @file numbered_files.cpp
/// Patterns, and sizes of files that others list.
#include "io/files/numbered_files.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>
#include <tetwarp/error.hpp>

#include "io/files/extension.hpp"

namespace tetwarp {
namespace fs = std::filesystem;

namespace {
bool is_digit(char letter) {
  return std::isdigit(static_cast<unsigned char>(letter)) != 0;
}

/// The digits from `at` on, without leading zeros; moves `at` behind them.
std::string number_at(const std::string& text, std::size_t& at) {
  while (at < text.size() && text[at] == '0') ++at;
  const std::size_t first = at;
  while (at < text.size() && is_digit(text[at])) ++at;
  return text.substr(first, at - first);
}

/// Compares numbers by their value, all else by the alphabet.
bool is_before(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      const std::string x = number_at(a, i), y = number_at(b, j);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
    }
  }
  const std::size_t left_a = a.size() - i, left_b = b.size() - j;
  return left_a != left_b ? left_a < left_b : a < b;
}

double bytes_of_file(const fs::path& path) {
  std::error_code error;
  const auto bytes = static_cast<double>(fs::file_size(path, error));
  return error ? 0 : bytes;
}

bool is_list(const std::string& path) {
  return has_extension(path, ".pvd") || has_extension(path, ".vtm") ||
         has_extension(path, ".series");
}

constexpr std::string_view blanks = " \t\r\n\v\f";

std::string trimmed(std::string_view text) {
  const std::size_t first = std::min(text.size(), text.find_first_not_of(blanks));
  return std::string(text.substr(first, text.find_last_not_of(blanks) + 1 - first));
}

/// The file of samples that a header of MetaImage or NRRD names; empty: none.
std::string samples_named_in(const std::string& path) {
  std::string text(1 << 16, '\0');
  std::ifstream in(path, std::ios::binary);
  in.read(text.data(), std::ssize(text));
  text.resize(static_cast<std::size_t>(in.gcount()));
  text.resize(std::min(text.size(), text.find('\0')));  // samples may follow
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.size(), text.find_first_of("\r\n", at));
    const std::string line = trimmed(std::string_view(text).substr(at, end - at));
    at = end + 1;
    for (const std::string_view key : {"data file:", "datafile:"}) {
      if (line.starts_with(key)) return trimmed(std::string_view(line).substr(key.size()));
    }
    const std::size_t sign = line.find('=');
    if (sign != std::string::npos && trimmed(line.substr(0, sign)) == "ElementDataFile") {
      return trimmed(line.substr(sign + 1));
    }
  }
  return "";
}

/// The texts in quotes behind each `key` and `sign`, with blanks or without around the sign.
void add_quoted(const std::string& text,
                std::string_view key,
                char sign,
                std::vector<std::string>& found) {
  const auto past_blanks = [&](std::size_t at) {
    return std::min(text.size(), text.find_first_not_of(blanks, at));
  };
  for (std::size_t at = 0; (at = text.find(key, at)) != std::string::npos;) {
    at = past_blanks(at + key.size());
    if (at >= text.size() || text[at] != sign) continue;
    at = past_blanks(at + 1);
    if (at >= text.size() || (text[at] != '"' && text[at] != '\'')) continue;
    const std::size_t end = text.find_first_of("\"'", at + 1);
    if (end == std::string::npos) return;
    found.push_back(text.substr(at + 1, end - at - 1));
    at = end + 1;
  }
}

/// Adds the other file of a pair of header and samples: of MetaImage, NRRD and NIfTI.
void add_partner(const std::string& path, std::vector<std::string>& files) {
  const auto add = [&](const fs::path& file) {
    std::error_code error;
    if (file != path && fs::is_regular_file(file, error)) files.push_back(file.string());
  };
  if (has_extension(path, ".mhd") || has_extension(path, ".nhdr")) {
    const std::string samples = samples_named_in(path);
    if (!samples.empty()) add(fs::path(path).parent_path() / samples);
  }
  const std::vector<std::string> ends{".hdr", ".hdr.gz", ".img", ".img.gz"};
  for (const std::string& end : ends) {
    if (!has_extension(path, end)) continue;
    for (const std::string& other : ends) add(path.substr(0, path.size() - end.size()) + other);
  }
}

/// Adds a file and those that it lists. @param depth  of lists that lists may name
void add_files(const std::string& path, int depth, std::vector<std::string>& files) {
  files.push_back(path);
  add_partner(path, files);
  if (!is_list(path) || depth == 0) return;
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  std::vector<std::string> listed;
  add_quoted(text, "file", '=', listed);
  add_quoted(text, "\"name\"", ':', listed);
  for (const std::string& name : listed) {
    const fs::path named = fs::path(path).parent_path() / name;
    std::error_code error;
    if (fs::is_regular_file(named, error)) add_files(named.string(), depth - 1, files);
  }
}
}  // namespace

bool is_pattern(const std::string& path) {
  std::error_code error;
  return fs::path(path).filename().string().find('*') != std::string::npos &&
         !fs::exists(path, error);
}

std::vector<std::string> numbered_files(const std::string& pattern) {
  const fs::path parent = fs::path(pattern).parent_path();
  const std::string names = fs::path(pattern).filename().string();
  std::vector<std::string> found;
  std::error_code error;
  for (fs::directory_iterator at(parent.empty() ? "." : parent, error), end; !error && at != end;
       at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (fnmatch(names.c_str(), name.c_str(), FNM_NOESCAPE | FNM_PERIOD) == 0) found.push_back(name);
  }
  if (found.empty()) throw IoError(pattern, "", "no file has such a name");
  std::ranges::sort(found, is_before);
  for (std::string& name : found) name = (parent / name).string();
  return found;
}

bool is_exodus_name(const std::string& path) {
  return has_extension(path, ".e") || has_extension(path, ".exo") || has_extension(path, ".ex2");
}

std::vector<std::string> files_of(const std::string& path) {
  std::vector<std::string> files;
  std::error_code error;
  if (fs::is_directory(path, error)) {
    for (fs::directory_iterator at(path, error), end; !error && at != end; at.increment(error)) {
      if (at->is_regular_file(error)) files.push_back(at->path().string());
    }
    std::ranges::sort(files);
    return files;
  }
  constexpr int depth = 2;
  if (!is_pattern(path)) {
    add_files(path, depth, files);
    return files;
  }
  for (const std::string& file : numbered_files(path)) add_files(file, depth, files);
  return files;
}

double bytes_of_files(const std::string& path) {
  double bytes = 0;
  for (const std::string& file : files_of(path)) bytes += bytes_of_file(file);
  return bytes;
}

}  // namespace tetwarp
