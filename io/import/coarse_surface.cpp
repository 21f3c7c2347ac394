/// @file coarse_surface.cpp
/// Hands a surface over in a file that is removed afterwards.
#include "io/import/coarse_surface.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iomanip>
#include <sstream>
#include <system_error>

#include "io/child/reader_program.hpp"
#include "io/files/scratch_file.hpp"

namespace tetwarp {
namespace {
/// A file of the temporary folder, removed with this object.
class HandedFile {
 public:
  explicit HandedFile(const std::string& beside)
      : name_((std::filesystem::temp_directory_path() / "tetwarp-surface-XXXXXX").string()),
        descriptor_(mkstemp(name_.data())),
        beside_(beside) {
    if (descriptor_ < 0) fail();
  }
  HandedFile(const HandedFile&) = delete;
  HandedFile& operator=(const HandedFile&) = delete;
  ~HandedFile() {
    if (descriptor_ < 0) return;
    close(descriptor_);
    unlink(name_.c_str());
  }

  const std::string& name() const { return name_; }
  template <class T>
  void append(const T* items, std::size_t count) {
    if (!write_at(descriptor_, items, count * sizeof(T), size_)) fail();
    size_ += static_cast<std::int64_t>(count * sizeof(T));
  }

 private:
  [[noreturn]] void fail() const {
    throw IoError(
        beside_, "",
        "the temporary folder cannot be written to: " + std::generic_category().message(errno));
  }

  std::string name_;
  int descriptor_;
  std::string beside_;
  std::int64_t size_ = 0;
};
}  // namespace

Surface coarse_surface(const std::string& path, const Surface& surface, double distance) {
  HandedFile file(path);
  const std::uint64_t counts[2] = {surface.points.size(), surface.triangles.size()};
  file.append(counts, 2);
  file.append(surface.points.data(), surface.points.size());
  file.append(surface.triangles.data(), surface.triangles.size());
  std::ostringstream words;
  words << std::setprecision(17) << distance;
  Surface coarse;
  try {
    run_reader(file.name(), {"coarsen", words.str()}, limits_for(file.name()), [&](auto& message) {
      message(coarse.points);
      message(coarse.triangles);
    });
  } catch (const IoError& error) {
    const std::string names = IoError(error.file(), error.dataset(), "").what();
    throw IoError(path, "", std::string(error.what()).substr(names.size()));
  }
  return coarse;
}

}  // namespace tetwarp
