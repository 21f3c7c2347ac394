/// @file fuzz_io.cpp
/// Usage: fuzz_io SECONDS SEED [NAME...]
///
/// Damages good files, by bytes and by values, and reads them with every reader. Success or an
/// IoError passes; a crash, a hang, another exception or a large allocation fails. Files are read
/// in forked children, so that crashes can be counted; those inside HDF5 are counted separately.
/// With names, of files that write_seeds() writes, only these are damaged.
#include <dlfcn.h>
#include <execinfo.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <limits>
#include <new>
#include <random>
#include <string>
#include <tetwarp/point_file.hpp>
#include <tetwarp/scene_io.hpp>
#include <tetwarp/surface_reader.hpp>
#include <tetwarp/transform_file.hpp>
#include <utility>
#include <variant>
#include <vector>

#include "tests/io/fuzz_bytes.hpp"
#include "tests/io/fuzz_contact.hpp"
#include "tests/io/fuzz_memory.hpp"
#include "tests/io/fuzz_transforms.hpp"
#include "tests/io/fuzz_values.hpp"
#include "tests/support/curved_scenes.hpp"
#include "tests/support/io_files.hpp"

namespace {
using namespace tetwarp;
using Clock = std::chrono::steady_clock;

constexpr time_t seconds_per_file = 5;           // of the processor
constexpr unsigned wall_seconds_per_file = 120;  // also on a busy machine
constexpr std::int64_t files_per_child = 64;

/// Exit codes of a child that ends before its last file.
enum ExitCode { crash_in_hdf5 = 40, crash, wrong_exception };

/// Written by the children, read by the parent.
struct Counts {
  std::int64_t files = 0;
  std::int64_t rejected = 0;
  std::int64_t read = 0;
};

/// Ends the child. The crash is attributed to the first frame outside the C library and sanitizers.
void on_crash(int) {
  std::array<void*, 64> frames{};
  const int count = backtrace(frames.data(), static_cast<int>(frames.size()));
  for (int frame = 1; frame < count; ++frame) {
    Dl_info where{};
    if (dladdr(frames[static_cast<std::size_t>(frame)], &where) == 0) continue;
    const std::string object = where.dli_fname == nullptr ? "" : where.dli_fname;
    if (object.find("libhdf5") != std::string::npos) _exit(crash_in_hdf5);
    const bool is_system = object.find("libc.so") != std::string::npos ||
                           object.find("libasan") != std::string::npos ||
                           object.find("libubsan") != std::string::npos;
    if (!is_system && frame > 1) break;
  }
  backtrace_symbols_fd(frames.data(), count, STDERR_FILENO);
  _exit(crash);
}

void write_seeds(const test::ScratchFolder& folder) {
  const Volume a = test::counting_volume(PixelType::int16, 1, "a");
  const Volume b = test::counting_volume(PixelType::float32, 3, "b");
  write_volumes(folder / "volume", {&a, &b}, {.compress = 0, .background = 0, .fingerprint = "f"});
  write_volumes(folder / "packed", {&a, &b}, {.compress = 3, .background = 0, .fingerprint = {}});
  TemporalVolumeWriter writer(folder / "temporal");
  writer.append(0, {&a, &b});
  writer.repeat(1);
  writer.append(2, {&a, &b});
  writer.finish();
  const Volume field = test::counting_volume(PixelType::float32, 3, "tetwarp_displacement");
  write_volumes(folder / "field", {&field}, {.compress = 3});
  write_nifti(folder / "field.nii.gz", field, Axes::lps);
  write_surface(folder / "surface", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
  write_mesh(folder / "mesh", test::two_tets());
  write_mesh(folder / "moving", test::two_tets(), test::slides({0, 1, 2}));
  write_mesh(folder / "curved", test::with_mid_nodes(test::two_tets()));
  write_nifti(folder / "v.nii", b);
  write_nifti(folder / "v.nii.gz", a);
  write_nifti(folder / "v2.nii", make_volume({.dims = {33000, 1, 1}}, PixelType::uint8));
  BlockVolumeWriter series(folder / "s.nii.gz", b.grid, {{b.name, b.type, b.components}},
                           {.fingerprint = "f"}, true);
  for (const double time : {0.0, 1.0}) {
    series.begin_step(time);
    series.write(0, {{0, 0, 0}, b.grid.dims}, b.data.data());
  }
  series.finish();
  NiftiFacts warp_field;
  warp_field.intent_code = 2006;
  BlockVolumeWriter fsl(folder / "fsl.nii", b.grid, {{b.name, b.type, 1, warp_field}}, {}, true);
  const Volume one = make_volume(b.grid, b.type);
  for (const double time : {0.0, 1.0, 2.0}) {
    fsl.begin_step(time);
    fsl.write(0, {{0, 0, 0}, b.grid.dims}, one.data.data());
  }
  fsl.finish();
  test::write_contact_seeds(folder);
  for (const std::string& name :
       std::vector<std::string>{"i.nrrd", "packed.nrrd", "steps.nrrd", "i.mha", "packed.mha",
                                "steps.mha", "i.mgh", "i.mgz"}) {
    const Volume& volume = name.find(".mg") == std::string::npos ? b : a;
    const bool is_series = name.starts_with("steps");
    BlockVolumeWriter image(folder / name, volume.grid,
                            {{volume.name, volume.type, volume.components}},
                            {.compress = name.starts_with("packed") ? 3 : 0}, is_series);
    for (int step = 0; step < (is_series ? 2 : 1); ++step) {
      if (is_series) image.begin_step(step);
      image.write(0, {{0, 0, 0}, volume.grid.dims}, volume.data.data());
    }
    image.finish();
  }
  const auto write = [&](const std::string& name, const std::string& text) {
    std::ofstream(folder / name, std::ios::binary) << text;
  };
  write("p.csv", "label,x,y,z\n\"a, b\",1,2.5,-3e1\nc,4,5,6\n");
  write("p.fcsv", "# CoordinateSystem = LPS\n# columns = id,x,y,z,ow\n1,1,2,3,0\n2,4,5,6,0\n");
  write(
      "p.json",
      R"({"markups": [{"coordinateSystem": "LPS", "controlPoints": [{"position": [1, 2, 3]}]}]})");
  test::write_transform_seeds(folder);
}

/// Formats that are chosen by the end of a name, and NRRD.
constexpr std::array<const char*, 14> named_seeds = {
    "i.nrrd", "packed.nrrd", "steps.nrrd", "i.mha",  "packed.mha", "steps.mha", "i.mgh",
    "i.mgz",  "p.csv",       "p.fcsv",     "p.json", "t.tfm",      "b.tfm",     "t.mat"};

std::vector<std::string> seed_names() {
  std::vector<std::string> names = {"volume", "packed",   "temporal", "field",        "mesh",
                                    "moving", "curved",   "surface",  "v.nii",        "v.nii.gz",
                                    "v2.nii", "s.nii.gz", "fsl.nii",  "field.nii.gz", "itk"};
  names.insert(names.end(), test::contact_seeds.begin(), test::contact_seeds.end());
  names.insert(names.end(), named_seeds.begin(), named_seeds.end());
  return names;
}

void damage_file(const std::string& path, test::Random& random) {
  std::string bytes = tetwarp::test::bytes_of(path);
  test::damage_bytes(bytes, random);
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

/// True when `op` ends without IoError.
template <class Op>
bool reads(const Op& op) {
  try {
    op();
    return true;
  } catch (const IoError& error) {
    if (std::strchr(error.what(), '\n') != nullptr) throw std::runtime_error(error.what());
    return false;
  }
}

/// Reads the last voxel of each field of a transform.
void read_field_parts(const std::string& path) {
  TransformParts parts = open_transform(path, {.image = path});
  auto* const chain = std::get_if<TransformChain>(&parts.file.transform);
  for (std::size_t n = 0; n < parts.fields.size(); ++n) {
    const auto* const field = chain == nullptr
                                  ? std::get_if<DisplacementField>(&parts.file.transform)
                                  : std::get_if<DisplacementField>(&chain->links[n]);
    if (field == nullptr) continue;
    std::array<float, 3> displacement{};
    Region last{{}, field->grid.dims};
    for (std::size_t axis = 0; axis < 3; ++axis) last.begin[axis] = last.end[axis] - 1;
    parts.fields[n].read(last, displacement.data());
  }
}

/// Runs every reader on one file. @returns true when the reader of its kind succeeded
bool read_all(const std::string& path) {
  reads([&] { kind_of(path); });
  reads([&] { read_fingerprint(path); });
  const bool is_volume = reads([&] {
    const VolumeHeader header = read_volume_header(path);
    const std::size_t steps = std::max<std::size_t>(1, header.times.size());
    for (const ArrayHeader& array : header.arrays) {
      for (std::size_t step = 0; step < steps; ++step) {
        read_volume(path, array.name, static_cast<std::int64_t>(step));
      }
    }
  });
  reads([&] { read_volume(path); });
  reads([&] { read_volume(path, "", 0, {.are_labels = true}); });
  reads([&] {
    std::array<std::byte, 72> voxel{};  // nine components of eight bytes
    VolumeReader(path).read({{0, 0, 0}, {1, 1, 1}}, voxel.data());
  });
  const bool is_mesh = reads([&] {
    const MeshReader reader(path, {.rest_step = 0, .rest_file = path});
    for (std::size_t step = 0; step < reader.header().times.size(); ++step) {
      reader.read_step(static_cast<std::int64_t>(step));
    }
  });
  const bool is_surface = reads([&] {
    is_surface_file(path);
    read_surface(path);
    const SurfaceReader reader(path);
    for (std::int64_t step = 0; step < reader.step_count(); ++step) reader.points(step);
  });
  const bool is_transform = reads([&] { read_transform(path, {.image = path}); });
  reads([&] { read_field_parts(path); });
  const bool is_contact = reads([&] { test::read_contact_file(path, path + "-solved"); });
  return is_volume || is_mesh || is_surface || is_transform || is_contact ||
         reads([&] { read_nifti(path); });
}

/// Reads a file whose name ends as the format wants. @returns true when one reader succeeded
bool read_named(const std::string& path, const std::string& extension) {
  const std::string named = path + extension;
  std::filesystem::copy_file(path, named, std::filesystem::copy_options::overwrite_existing);
  const bool is_points = reads([&] {
    const PointFile file(named);
    const std::vector<std::uint8_t> inside(file.points().size(), 1);
    file.write(path + "-moved" + extension, file.points(), inside);
  });
  const bool is_transform = reads([&] { read_transform(named); });
  return is_points || is_transform || read_all(named);
}

/// The file number `index` of this seed and these names: the same in every run.
/// @returns the end of its name, where the format is chosen by it
std::string make_file(const test::ScratchFolder& folder,
                      const std::vector<std::string>& names,
                      std::uint64_t seed,
                      std::int64_t index) {
  test::Random random(seed, static_cast<std::uint64_t>(index));
  const std::string& name = names[random.below(names.size())];
  std::filesystem::copy_file(folder / name, folder / "damaged",
                             std::filesystem::copy_options::overwrite_existing);
  const bool is_named =
      std::find(named_seeds.begin(), named_seeds.end(), name) != named_seeds.end();
  const bool is_hdf5 = name.find(".nii") == std::string::npos && !is_named;
  if (is_hdf5 && random.below(3) != 0) {
    test::damage_values(folder / "damaged", random);
  } else {
    damage_file(folder / "damaged", random);
  }
  return is_named ? name.substr(name.rfind('.')) : "";
}

/// Runs in a child: files from `first` on.
[[noreturn]] void read_files(const test::ScratchFolder& folder,
                             const std::vector<std::string>& names,
                             std::uint64_t seed,
                             std::int64_t first,
                             Clock::time_point end,
                             Counts& counts) {
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGABRT, SIGILL}) {
    std::signal(signal, on_crash);
  }
  for (std::int64_t index = first; index < first + files_per_child && Clock::now() < end; ++index) {
    alarm(wall_seconds_per_file);
    const itimerval limit{{0, 0}, {seconds_per_file, 0}};
    setitimer(ITIMER_PROF, &limit, nullptr);
    ++counts.files;
    try {
      const std::string extension = make_file(folder, names, seed, index);
      const bool is_read = extension.empty() ? read_all(folder / "damaged")
                                             : read_named(folder / "damaged", extension);
      ++(is_read ? counts.read : counts.rejected);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
      _exit(wrong_exception);
    }
  }
  _exit(0);
}

const char* text_of(int status) {
  if (WIFSIGNALED(status)) {
    return WTERMSIG(status) == SIGALRM || WTERMSIG(status) == SIGPROF ? "hang" : "killed";
  }
  switch (WEXITSTATUS(status)) {
    case crash_in_hdf5:
      return "crash inside HDF5";
    case crash:
      return "crash";
    case wrong_exception:
      return "exception that is no IoError";
    case test::large_allocation_exit_code:
      return "allocation out of all proportion";
    default:
      return "sanitizer report";
  }
}

/// Reads damaged files for `seconds`. @returns true when none of them was a failure
bool fuzz(int seconds, std::uint64_t seed, const std::vector<std::string>& names) {
  const auto end = Clock::now() + std::chrono::seconds(seconds);
  const test::ScratchFolder folder;
  write_seeds(folder);
  void* shared =
      mmap(nullptr, sizeof(Counts), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) throw std::runtime_error("no shared memory");
  Counts& counts = *new (shared) Counts;

  int failures = 0;
  int hdf5_crashes = 0;
  while (Clock::now() < end && failures < 10) {
    const std::int64_t first = counts.files;
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("no child process");
    if (child == 0) read_files(folder, names, seed, first, end, counts);
    int status = 0;
    waitpid(child, &status, 0);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) continue;
    const bool is_hdf5 = WIFEXITED(status) && WEXITSTATUS(status) == crash_in_hdf5;
    ++(is_hdf5 ? hdf5_crashes : failures);
    const auto kept = std::filesystem::temp_directory_path() /
                      ("fuzz_io-" + std::to_string(seed) + "-" + std::to_string(counts.files - 1));
    std::filesystem::copy_file(folder / "damaged", kept,
                               std::filesystem::copy_options::overwrite_existing);
    std::printf("%s: %s\n", text_of(status), kept.c_str());
  }
  std::printf("%lld files, %lld rejected, %lld read\n", static_cast<long long>(counts.files),
              static_cast<long long>(counts.rejected), static_cast<long long>(counts.read));
  if (hdf5_crashes > 0) std::printf("%d crashes inside HDF5, not counted\n", hdf5_crashes);
  return failures == 0;
}
}  // namespace

// Sanitizers end the child so that it is counted; HDF5 copes with allocations that are refused.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): the sanitizers' names
extern "C" [[gnu::visibility("default")]] const char* __asan_default_options() {
  return "abort_on_error=1:detect_leaks=0:allocator_may_return_null=1";
}
extern "C" [[gnu::visibility("default")]] const char* __ubsan_default_options() {
  return "halt_on_error=1:abort_on_error=1";
}
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: fuzz_io SECONDS SEED [NAME...]\n");
    return 2;
  }
  try {
    std::vector<std::string> names(argv + 3, argv + argc);
    if (names.empty()) names = seed_names();
    const auto seed = static_cast<std::uint64_t>(std::atoll(argv[2]));
    return fuzz(std::atoi(argv[1]), seed, names) ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
