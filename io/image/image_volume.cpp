/// @file image_volume.cpp
/// Samples of images, read where they lie or unpacked to a temporary file.
#include "io/image/image_volume.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "io/files/component_facts.hpp"
#include "io/files/memory.hpp"
#include "io/files/read_check.hpp"
#include "io/files/scratch_file.hpp"
#include "io/image/meta_header.hpp"
#include "io/image/mgh_header.hpp"
#include "io/image/nrrd_header.hpp"
#include "io/nifti/nifti_components.hpp"
#include "io/nifti/nifti_runs.hpp"

namespace tetwarp {
namespace {
const std::string image_array = Volume{}.name;

ImageHeader read_header(const std::string& path) {
  return is_nrrd(path)         ? read_nrrd_header(path)
         : is_meta_image(path) ? read_meta_header(path)
                               : read_mgh_header(path);
}

/// A file that is open for reading.
class OpenFile {
 public:
  OpenFile(const std::string& path, const std::string& header) : path_(path) {
    descriptor_ = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor_ >= 0) return;
    throw IoError(header, "",
                  "its samples in '" + path + "' cannot be opened: " + std::strerror(errno));
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() { close(descriptor_); }

  int descriptor() const { return descriptor_; }
  std::int64_t size() const { return lseek(descriptor_, 0, SEEK_END); }

 private:
  std::string path_;
  int descriptor_ = -1;
};

/// Checks that a file can hold the samples of all steps.
void check_size(const std::string& path, const ImageHeader& header, const OpenFile& file) {
  // Packed by zlib, samples take no less than this share of their size.
  constexpr double least_share = 1.0 / 1040;
  const double share = header.is_packed ? least_share : 1;
  const double wanted = static_cast<double>(header.grid.voxel_count()) *
                        static_cast<double>(header.voxel_bytes()) *
                        static_cast<double>(header.steps) * share;
  const double after_header =
      static_cast<double>(file.size() - std::max<std::int64_t>(0, header.data_offset));
  if (wanted <= after_header) return;
  throw IoError(path, "",
                "its samples need " + bytes_text(wanted) + ", which '" + header.data_file +
                    "' does not have: truncated or damaged");
}

/// Unpacks zlib's and gzip's streams part by part.
class Unpacker {
 public:
  Unpacker(int descriptor, std::int64_t offset) : descriptor_(descriptor), offset_(offset) {
    constexpr int any_header = 15 + 32;
    is_sound_ = inflateInit2(&stream_, any_header) == Z_OK;
  }
  Unpacker(const Unpacker&) = delete;
  Unpacker& operator=(const Unpacker&) = delete;
  ~Unpacker() { inflateEnd(&stream_); }

  /// @returns false when the stream is damaged or ends before
  bool read(void* out, std::size_t bytes) {
    stream_.next_out = static_cast<Bytef*>(out);
    while (bytes > 0 && is_sound_) {
      if (stream_.avail_in == 0 && !fill()) return false;
      check_read();
      const auto part = static_cast<uInt>(std::min<std::size_t>(bytes, nifti_part_bytes));
      stream_.avail_out = part;
      const int state = inflate(&stream_, Z_NO_FLUSH);
      bytes -= part - stream_.avail_out;
      if (state == Z_STREAM_END && bytes > 0) return false;
      is_sound_ = state == Z_OK || state == Z_STREAM_END || state == Z_BUF_ERROR;
    }
    return is_sound_;
  }

 private:
  bool fill() {
    const ssize_t got = pread(descriptor_, packed_.data(), packed_.size(), offset_);
    if (got <= 0) return false;
    offset_ += got;
    stream_.next_in = packed_.data();
    stream_.avail_in = static_cast<uInt>(got);
    return true;
  }

  int descriptor_;
  std::int64_t offset_;
  z_stream stream_{};
  bool is_sound_ = false;
  std::vector<Bytef> packed_ = std::vector<Bytef>(nifti_part_bytes);
};

/// Turns numbers of the other byte order around.
void swap_bytes(std::byte* samples, std::size_t size, std::size_t count) {
  for (std::size_t n = 0; n < count; ++n)
    std::reverse(samples + n * size, samples + (n + 1) * size);
}

/// The array; of components along LPS with facts that tell them.
/// @throws IoError  as image_component_map()
ArrayHeader array_of(const std::string& path, const ImageHeader& header, Axes axes) {
  ArrayHeader array{image_array, header.type, header.components};
  if (axes == Axes::ras) return array;
  if (std::ranges::count(header.left_out, frame_fact) > 0) {
    throw IoError(path, frame_fact, "turns the components, which is not read; leave out --axes");
  }
  array.nifti = default_nifti_facts(header.components);
  array.nifti->component_axes = axes;
  static_cast<void>(image_component_map(path, header.type, header.components, axes));
  return array;
}

class ImageSource : public VolumeSource {
 public:
  ImageSource(const std::string& path, std::int64_t step, const VolumeReadOptions& options)
      : path_(path),
        header_(read_header(path)),
        array_(array_of(path, header_, options.axes)),
        scratch_(options.scratch),
        step_(step),
        file_(header_.data_file, path) {
    if (step < 0 || step >= header_.steps) {
      throw IoError(path, "",
                    "has no step " + std::to_string(step) + ", it has " +
                        std::to_string(header_.steps) + " from 0 on");
    }
    check_size(path, header_, file_);
    if (header_.data_offset >= 0) return;
    if (header_.is_packed) throw IoError(path, "", "a packed image needs the place of its samples");
    header_.data_offset = file_.size() - header_.steps * bytes();
  }

  const Grid& grid() const override { return header_.grid; }
  const ArrayHeader& array() const override { return array_; }
  std::vector<std::string> array_names() const override { return {array_.name}; }
  double chunk_bytes() const override {
    return header_.is_packed ? static_cast<double>(2 * nifti_part_bytes) : 0;
  }
  double unpacked_bytes() const override {
    return header_.is_packed ? static_cast<double>(bytes()) : 0;
  }

  void read(const Region& region, void* samples) override {
    auto* const out = static_cast<std::byte*>(samples);
    const auto voxels = static_cast<std::size_t>(region.voxel_count());
    const bool is_whole = region == Region{{0, 0, 0}, header_.grid.dims};
    if (header_.is_packed && is_whole && !unpacked_) {
      Unpacker unpacker(file_.descriptor(), header_.data_offset);
      skip(unpacker);
      if (!unpacker.read(out, header_.voxel_bytes() * voxels)) fail();
    } else {
      if (header_.is_packed && !unpacked_) unpack();
      read_runs(region, out);
    }
    const bool is_other = header_.is_big_endian == (std::endian::native == std::endian::little);
    const std::size_t size = size_of(header_.type);
    if (is_other && size > 1) {
      swap_bytes(out, size, voxels * static_cast<std::size_t>(header_.components));
    }
    if (array_.nifti) turn({out, header_.voxel_bytes() * voxels});
  }

 private:
  std::int64_t bytes() const {
    return header_.grid.voxel_count() * static_cast<std::int64_t>(header_.voxel_bytes());
  }
  /// From LPS to RAS.
  void turn(std::span<std::byte> samples) const {
    const std::array<bool, 9> turned = turned_components(header_.components);
    const std::size_t size = size_of(header_.type);
    for (std::size_t s = 0; s < samples.size() / size; ++s) {
      if (!turned[s % static_cast<std::size_t>(header_.components)]) continue;
      negate_samples(header_.type, samples.subspan(s * size, size));
    }
  }
  /// Reads over what is packed before the samples of the step.
  void skip(Unpacker& unpacker) const {
    std::vector<std::byte> part(nifti_part_bytes);
    for (std::int64_t left = header_.skipped + step_ * bytes(); left > 0;) {
      const std::int64_t count = std::min<std::int64_t>(left, std::ssize(part));
      if (!unpacker.read(part.data(), static_cast<std::size_t>(count))) fail();
      left -= count;
    }
  }
  [[noreturn]] void fail() const {
    throw IoError(path_, "", "its samples are damaged or truncated; write it again");
  }

  void read_runs(const Region& region, std::byte* out) const {
    const auto size = static_cast<std::int64_t>(header_.voxel_bytes());
    const int descriptor = unpacked_ ? unpacked_->descriptor() : file_.descriptor();
    const std::int64_t start = unpacked_ ? 0 : header_.data_offset + step_ * bytes();
    const bool is_read = for_each_run(
        header_.grid.dims, region, std::int64_t{1} << 24,
        [&](std::int64_t in_grid, std::int64_t in_region, std::int64_t count) {
          return read_at(descriptor, out + in_region * size, static_cast<std::size_t>(count * size),
                         start + in_grid * size);
        });
    if (!is_read) fail();
  }

  void unpack() {
    const std::string folder = std::filesystem::temp_directory_path().string();
    auto scratch = std::make_unique<ScratchFile>(scratch_.empty() ? folder + "/tetwarp" : scratch_);
    Unpacker unpacker(file_.descriptor(), header_.data_offset);
    skip(unpacker);
    std::vector<std::byte> part(nifti_part_bytes);
    for (std::int64_t done = 0; done < bytes();) {
      const auto count =
          static_cast<std::size_t>(std::min<std::int64_t>(std::ssize(part), bytes() - done));
      if (!unpacker.read(part.data(), count)) fail();
      if (!write_at(scratch->descriptor(), part.data(), count, done)) {
        throw IoError(path_, "",
                      std::string("cannot be unpacked: ") + std::strerror(errno) +
                          "; check the free space of the disk");
      }
      done += static_cast<std::int64_t>(count);
    }
    unpacked_ = std::move(scratch);
  }

  std::string path_;
  ImageHeader header_;
  ArrayHeader array_;
  std::string scratch_;
  std::int64_t step_;
  OpenFile file_;
  std::unique_ptr<ScratchFile> unpacked_;
};
}  // namespace

bool is_image(const std::string& path) {
  return is_nrrd(path) || is_meta_image(path) || is_mgh(path);
}

VolumeHeader read_image_volume_header(const std::string& path, Axes axes) {
  const ImageHeader header = read_header(path);
  VolumeHeader volume;
  volume.grid = header.grid;
  volume.arrays = {array_of(path, header, axes)};
  volume.active = image_array;
  volume.left_out = header.left_out;
  if (header.is_series) check_size(path, header, OpenFile(header.data_file, path));
  for (std::int64_t step = 0; header.is_series && step < header.steps; ++step) {
    volume.times.push_back(header.first_time + static_cast<double>(step) * header.time_step);
  }
  return volume;
}

std::unique_ptr<VolumeSource> open_image_source(const std::string& path,
                                                const std::string& array,
                                                std::int64_t step,
                                                const VolumeReadOptions& options) {
  if (!array.empty() && array != image_array) {
    throw IoError(path, array, "no such array; the image has one, called " + image_array);
  }
  return std::make_unique<ImageSource>(path, step, options);
}

}  // namespace tetwarp
