/// @file fuzz_mesh.cpp
/// Usage: fuzz_mesh SECONDS SEED [FORMAT or FILE]
///
/// Damages meshes, surfaces and images of other programs and reads them. A result or an IoError of
/// one line passes; a crash of this process, another exception or a crash of the project's code in
/// the reader, which is fuzz_mesh_reader, fails. Crashes and hangs inside VTK, Gmsh and GDCM are
/// counted. Without a format all take turns.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <tetwarp/io.hpp>
#include <tetwarp/mesh_import.hpp>
#include <tetwarp/point_file.hpp>
#include <vector>

#include "tests/io/fuzz_bytes.hpp"
#include "tests/io/fuzz_foreign_files.hpp"

namespace {
using namespace tetwarp;
using Clock = std::chrono::steady_clock;

constexpr double seconds_per_file = 10;
constexpr int max_failures = 10;

struct Counts {
  long files = 0, read = 0, rejected = 0, library_crashes = 0, library_hangs = 0, failures = 0;
};

bool has(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

/// Reads the arrays of an image: of a file in a folder of its own all of that folder.
void read_image(const std::filesystem::path& path) {
  const bool is_in_series = path.parent_path().filename() == "series";
  const std::string image = is_in_series ? path.parent_path() : path;
  for (const ArrayHeader& array : read_volume_header(image).arrays) read_volume(image, array.name);
}

/// Moves the points of a surface, and writes it.
void place_points(const std::string& path) {
  const PointFile file(path);
  const std::vector<std::uint8_t> inside(file.points().size(), 1);
  file.write(path + "-moved" + std::filesystem::path(path).extension().string(), file.points(),
             inside);
}

/// Reads a file as a user does.
void read_file(const std::string& path) {
  const bool is_surface = has_surface_extension(path);
  if (!is_surface && !has_mesh_extension(path)) return read_image(path);
  import_mesh(path,
              {.displacement = {}, .time_limit = seconds_per_file, .needs_solids = !is_surface});
  if (is_surface) place_points(path);
}

/// Reads a damaged file. @returns an empty text, or what is wrong
std::string read_once(const std::string& path, Counts& counts) {
  try {
    read_file(path);
    ++counts.read;
  } catch (const IoError& error) {
    const std::string line = error.what();
    counts.library_crashes += has(line, "its reader crashed") || has(line, "without a result");
    counts.library_hangs += has(line, "its reader took");
    ++counts.rejected;
    if (has(line, "\n")) return "an error of several lines";
    if (has(line, "this build cannot read")) return "";
  } catch (const std::exception& error) {
    return error.what();
  }
  return std::filesystem::exists(std::getenv("FUZZ_MESH_TRACE")) ? "crash outside of the libraries"
                                                                 : "";
}

std::string content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<test::ForeignMesh> chosen_meshes(const std::string& choice) {
  if (std::filesystem::exists(choice)) {
    return {{choice, std::filesystem::path(choice).filename().string(), content_of(choice)}};
  }
  std::vector<test::ForeignMesh> chosen;
  std::vector<test::ForeignMesh> all = test::foreign_meshes();
  for (const auto& more : {test::foreign_surfaces(), test::foreign_images()}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  for (const test::ForeignMesh& mesh : all) {
    if (choice.empty() || choice == mesh.format) chosen.push_back(mesh);
  }
  if (chosen.empty()) throw std::runtime_error(choice + ": no such format or file");
  return chosen;
}

void write_file(const std::filesystem::path& path, const std::string& content) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary | std::ios::trunc) << content;
}

/// Reads the undamaged files. A build without the libraries reads none.
void read_good(const std::filesystem::path& folder, const std::vector<test::ForeignMesh>& meshes) {
  for (const test::ForeignMesh& mesh : meshes) {
    const std::string path = folder / mesh.name;
    write_file(path, mesh.content);
    try {
      read_file(path);
    } catch (const IoError& error) {
      if (!has(error.what(), "this build cannot read")) throw;
    }
  }
}

bool fuzz(int seconds, std::uint64_t seed, const std::string& choice) {
  std::string name = (std::filesystem::temp_directory_path() / "fuzz_mesh-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  const std::filesystem::path folder = name;
  setenv("TETWARP_READER", FUZZ_MESH_READER, 1);
  setenv("FUZZ_MESH_TRACE", (folder / "trace").c_str(), 1);
  const std::vector<test::ForeignMesh> meshes = chosen_meshes(choice);
  for (const test::ForeignMesh& part : {test::listed_part, test::good_slice}) {
    write_file(folder / part.name, part.content);
  }
  read_good(folder, meshes);
  Counts counts;
  const auto end = Clock::now() + std::chrono::seconds(seconds);
  for (std::uint64_t index = 0; Clock::now() < end && counts.failures < max_failures; ++index) {
    test::Random random(seed, index);
    const test::ForeignMesh& mesh = meshes[index % meshes.size()];
    std::string content = mesh.content;
    const std::size_t kind = random.below(3);
    if (kind != 0) test::damage_numbers(content, random);
    if (kind != 1) test::damage_bytes(content, random);
    const std::string path = folder / mesh.name;
    write_file(path, content);
    ++counts.files;
    const std::string problem = read_once(path, counts);
    if (problem.empty()) continue;
    ++counts.failures;
    const auto kept = std::filesystem::temp_directory_path() /
                      ("fuzz_mesh-" + std::to_string(seed) + "-" + std::to_string(index) + "-" +
                       std::filesystem::path(mesh.name).filename().string());
    std::filesystem::copy_file(path, kept, std::filesystem::copy_options::overwrite_existing);
    std::printf("%s: %s\n%s", problem.c_str(), kept.c_str(), content_of(folder / "trace").c_str());
    std::filesystem::remove(folder / "trace");
  }
  std::printf("%s: %ld files, %ld rejected, %ld read, %ld crashes and %ld hangs inside libraries\n",
              choice.empty() ? "all" : choice.c_str(), counts.files, counts.rejected, counts.read,
              counts.library_crashes, counts.library_hangs);
  std::filesystem::remove_all(folder);
  return counts.failures == 0;
}
}  // namespace

int main(int argc, char** argv) {
  if (argc < 3 || argc > 4) {
    std::fprintf(stderr, "usage: fuzz_mesh SECONDS SEED [FORMAT or FILE]\n");
    return 2;
  }
  try {
    const std::string choice = argc == 4 ? argv[3] : "";
    return fuzz(std::atoi(argv[1]), static_cast<std::uint64_t>(std::atoll(argv[2])), choice) ? 0
                                                                                             : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
