/// @file leftover_files.cpp
/// Names of temporary files hold the process that made them, which tells whether it still runs.
#include "io/files/leftover_files.hpp"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <set>
#include <string_view>
#include <system_error>
#include <vector>

namespace tetwarp {
namespace {
/// Eight digits from the names of the machine and of its numbering of processes.
std::string place_of_processes() {
  std::array<char, 512> host{}, numbering{};
  gethostname(host.data(), host.size() - 1);
  if (readlink("/proc/self/ns/pid", numbering.data(), numbering.size() - 1) < 0) numbering[0] = 0;
  std::uint32_t hash = 2166136261;  // FNV-1a
  for (const char* text : {host.data(), numbering.data()}) {
    for (; *text != 0; ++text) hash = (hash ^ static_cast<unsigned char>(*text)) * 16777619;
  }
  std::array<char, 9> digits{};
  std::snprintf(digits.data(), digits.size(), "%08x", hash);
  return digits.data();
}

/// Whether a name is that of a temporary file of a process of this machine that has ended.
bool is_leftover(const std::string& name) {
  pid_t process = 0;
  const char* const end = name.data() + name.size();
  if (!name.starts_with('.')) return false;
  const char* past = std::from_chars(name.data() + 1, end, process).ptr;
  const std::string place = "-" + place_of_processes() + ".";
  if (process <= 0 || !std::string_view(past, end).starts_with(place)) return false;
  past += place.size();
  int count = 0;
  const auto [after, error] = std::from_chars(past, end, count);
  return error == std::errc() && std::string_view(after, end).starts_with(".tmp.") &&
         kill(process, 0) != 0 && errno == ESRCH;
}
}  // namespace

std::string temporary_start() {
  return "." + std::to_string(getpid()) + "-" + place_of_processes() + ".";
}

void remove_leftovers_once(const std::string& folder) {
  static std::mutex lock;
  static std::set<std::string> seen;
  {
    const std::lock_guard guard(lock);
    if (!seen.insert(folder).second) return;
  }
  std::error_code error;
  std::vector<std::string> names;
  for (std::filesystem::directory_iterator entry(folder.empty() ? "." : folder, error), end;
       !error && entry != end; entry.increment(error)) {
    names.push_back(entry->path().filename().string());
  }
  for (const std::string& name : names) {
    if (is_leftover(name)) unlink((folder + name).c_str());
  }
}

}  // namespace tetwarp
