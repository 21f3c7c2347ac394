/// @file run_command.hpp
/// Runs the executable `tetwarp` in temporary folders, for the tests of the command.
#pragma once
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

namespace tetwarp::test {
namespace fs = std::filesystem;

/// A folder in the system's temporary folder, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "tetwarp-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::permissions(path_, fs::perms::owner_all, ignored);
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const fs::path& path() const { return path_; }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

  /// Sorted names of all entries, hidden ones too.
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(path_)) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

 private:
  fs::path path_;
};

inline std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_text(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// How a command ended.
struct CommandResult {
  int exit_code = -1;  ///< 128 + signal when it was killed
  std::string out;
  std::string err;
  double peak_memory = 0;  ///< bytes, of it or of the caller when it started: the larger

  /// One line on standard error, beginning like all errors of the command.
  bool has_one_line_error() const {
    return err.starts_with("tetwarp: ") && err.find('\n') == err.size() - 1;
  }
};

/// How to run it.
struct RunOptions {
  rlim_t file_size_limit = RLIM_INFINITY;  ///< bytes; a larger write fails as on a full disk
  std::string out = {};                    ///< file for standard output; empty: collected
  std::string err = {};                    ///< the same for standard error, e.g. a terminal
  std::vector<std::string> launcher = {};  ///< words before the command's name
};

/// The executable with its working folder set to `folder`, from its start to its end.
class RunningCommand {
 public:
  RunningCommand(const TemporaryFolder& folder,
                 std::vector<std::string> words,
                 const RunOptions& options = {})
      : out_(options.out.empty() ? streams_ / "out" : options.out),
        err_(options.err.empty() ? streams_ / "err" : options.err) {
    words.insert(words.begin(), TETWARP_COMMAND);
    words.insert(words.begin(), options.launcher.begin(), options.launcher.end());
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    child_ = fork();
    if (child_ < 0) throw std::runtime_error("fork failed");
    if (child_ == 0) start(folder, arguments, options);
  }

  pid_t process() const { return child_; }

  CommandResult wait() {
    int status = 0;
    rusage used{};
    wait4(child_, &status, 0, &used);
    const bool ended = WIFEXITED(status);
    return {ended ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
            fs::is_regular_file(out_) ? text_of(out_) : "",
            fs::is_regular_file(err_) ? text_of(err_) : "",
            1024.0 * static_cast<double>(used.ru_maxrss)};
  }

 private:
  [[noreturn]] void start(const TemporaryFolder& folder,
                          const std::vector<char*>& arguments,
                          const RunOptions& options) const {
    const rlimit limit{options.file_size_limit, options.file_size_limit};
    setrlimit(RLIMIT_FSIZE, &limit);
    const int out = open(out_.c_str(), O_WRONLY | O_CREAT, 0600);
    const int err = open(err_.c_str(), O_WRONLY | O_CREAT, 0600);
    if (dup2(out, STDOUT_FILENO) >= 0 && dup2(err, STDERR_FILENO) >= 0 &&
        chdir(folder.path().c_str()) == 0) {
      execv(arguments.front(), arguments.data());
    }
    _exit(127);
  }

  TemporaryFolder streams_;
  std::string out_;
  std::string err_;
  pid_t child_ = -1;
};

inline CommandResult run_command(const TemporaryFolder& folder,
                                 const std::vector<std::string>& words,
                                 const RunOptions& options = {}) {
  return RunningCommand(folder, words, options).wait();
}

/// The sanitizer alone takes more memory than a test of a limit allows.
#ifdef __SANITIZE_ADDRESS__
constexpr bool has_address_sanitizer = true;
#else
constexpr bool has_address_sanitizer = false;
#endif

/// Why this build cannot read one of the meshes of the folder; empty if it reads all.
inline std::string missing_readers(const TemporaryFolder& folder,
                                   const std::vector<std::string>& meshes) {
  for (const std::string& name : meshes) {
    std::string message = run_command(folder, {"info", name}).err;
    if (message.find("this build cannot read") != std::string::npos) return message;
  }
  return "";
}

}  // namespace tetwarp::test
