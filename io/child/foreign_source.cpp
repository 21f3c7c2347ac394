/// @file foreign_source.cpp
/// Headers of such images, and their samples through a temporary file.
#include "io/child/foreign_source.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "io/child/foreign_image.hpp"
#include "io/files/read_check.hpp"
#include "io/files/scratch_file.hpp"
#include "io/nifti/nifti_runs.hpp"

namespace tetwarp {
namespace {
class ForeignSource : public VolumeSource {
 public:
  ForeignSource(const std::string& path, const std::string& array, const VolumeReadOptions& options)
      : path_(path),
        series_(options.series),
        scratch_(options.scratch),
        image_(read_image_in_child(path, options.series)) {
    const std::string& name = array.empty() ? image_.active : array;
    for (const ForeignArray& one : image_.arrays) {
      if (one.name == name) array_ = {one.name, one.type, one.components};
    }
    if (array_.name != name) throw IoError(path, name, "no such array");
  }

  const Grid& grid() const override { return image_.grid; }
  const ArrayHeader& array() const override { return array_; }
  std::vector<std::string> array_names() const override {
    std::vector<std::string> names;
    for (const ForeignArray& array : image_.arrays) names.push_back(array.name);
    return names;
  }
  /// A slice, and parts of it on the way.
  double chunk_bytes() const override {
    return static_cast<double>(nifti_part_bytes) +
           static_cast<double>(bytes()) / static_cast<double>(image_.grid.dims[2]);
  }
  double unpacked_bytes() const override { return static_cast<double>(bytes()); }

  void read(const Region& region, void* samples) override {
    auto* const out = static_cast<std::byte*>(samples);
    if (region == Region{{0, 0, 0}, image_.grid.dims} && !unpacked_) {
      std::size_t done = 0;
      receive([&](const void* slice, std::size_t count) {
        std::memcpy(out + done, slice, count);
        done += count;
      });
      return;
    }
    if (!unpacked_) unpack();
    const std::int64_t size = voxel_bytes();
    const bool is_read =
        for_each_run(image_.grid.dims, region, std::int64_t{1} << 24,
                     [&](std::int64_t in_grid, std::int64_t in_region, std::int64_t count) {
                       return read_at(unpacked_->descriptor(), out + in_region * size,
                                      static_cast<std::size_t>(count * size), in_grid * size);
                     });
    if (!is_read) throw IoError(path_, "", "its temporary copy cannot be read");
  }

 private:
  std::int64_t voxel_bytes() const {
    return array_.components * static_cast<std::int64_t>(size_of(array_.type));
  }
  std::int64_t bytes() const { return image_.grid.voxel_count() * voxel_bytes(); }

  void receive(const TakeSlice& take) const {
    read_samples_in_child(path_, series_, image_, array_.name,
                          [&](const void* slice, std::size_t count) {
                            check_read();
                            take(slice, count);
                          });
  }

  void unpack() {
    const std::string folder = std::filesystem::temp_directory_path().string();
    auto scratch = std::make_unique<ScratchFile>(scratch_.empty() ? folder + "/tetwarp" : scratch_);
    std::int64_t done = 0;
    receive([&](const void* slice, std::size_t count) {
      if (!write_at(scratch->descriptor(), slice, count, done)) {
        throw IoError(path_, "",
                      std::string("cannot be unpacked: ") + std::strerror(errno) +
                          "; check the free space of the disk");
      }
      done += static_cast<std::int64_t>(count);
    });
    unpacked_ = std::move(scratch);
  }

  std::string path_;
  std::string series_;
  std::string scratch_;
  ForeignImage image_;
  ArrayHeader array_;
  std::unique_ptr<ScratchFile> unpacked_;
};
}  // namespace

VolumeHeader read_foreign_volume_header(const std::string& path, const VolumeReadOptions& options) {
  const ForeignImage image = read_image_in_child(path, options.series);
  VolumeHeader header;
  header.grid = image.grid;
  for (const ForeignArray& array : image.arrays) {
    header.arrays.push_back({array.name, array.type, array.components});
  }
  header.active = image.active;
  header.not_read = image.not_read;
  header.left_out = image.left_out;
  header.notes = image.notes;
  return header;
}

std::unique_ptr<VolumeSource> open_foreign_source(const std::string& path,
                                                  const std::string& array,
                                                  std::int64_t step,
                                                  const VolumeReadOptions& options) {
  if (step != 0) {
    throw IoError(path, "", "has no step " + std::to_string(step) + ", it has one, step 0");
  }
  return std::make_unique<ForeignSource>(path, array, options);
}

}  // namespace tetwarp
