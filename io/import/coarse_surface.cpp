/// @file coarse_surface.cpp
/// Hands a surface over in a file without a name.
#include "io/import/coarse_surface.hpp"

#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <iomanip>
#include <sstream>
#include <system_error>

#include "io/child/reader_program.hpp"
#include "io/files/scratch_file.hpp"

namespace tetwarp {
namespace {
/// Writes a surface as tetwarp-read takes it. @returns false where there is no room
bool write_surface(const Surface& surface, const ScratchFile& file) {
  const std::uint64_t counts[2] = {surface.points.size(), surface.triangles.size()};
  std::int64_t end = 0;
  const auto append = [&](const auto* items, std::size_t count) {
    const std::size_t bytes = count * sizeof *items;
    const std::int64_t begin = end;
    end += static_cast<std::int64_t>(bytes);
    return write_at(file.descriptor(), items, bytes, begin);
  };
  return append(counts, 2) && append(surface.points.data(), surface.points.size()) &&
         append(surface.triangles.data(), surface.triangles.size());
}
}  // namespace

Surface coarse_surface(const std::string& path, const Surface& surface, double distance) {
  std::ostringstream words;
  words << std::setprecision(17) << distance;
  Surface coarse;
  try {
    const ScratchFile file((std::filesystem::temp_directory_path() / "tetwarp-surface").string());
    if (!write_surface(surface, file)) {
      throw IoError(path, "",
                    "the temporary folder has no room for its surface: " +
                        std::generic_category().message(errno));
    }
    run_reader(file.path(), {"coarsen", words.str()}, limits_for(file.path()), [&](auto& message) {
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
