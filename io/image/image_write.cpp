/// @file image_write.cpp
/// A header, then the samples in place, or packed when all are there.
#include "io/image/image_write.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "io/files/extension.hpp"
#include "io/files/finished_file.hpp"
#include "io/files/scratch_file.hpp"
#include "io/files/sink_checks.hpp"
#include "io/image/meta_header.hpp"
#include "io/image/nrrd_header.hpp"
#include "io/nifti/nifti_components.hpp"
#include "io/nifti/nifti_runs.hpp"

namespace tetwarp {
namespace {
class ImageSink : public VolumeSink {
 public:
  ImageSink(const std::string& path,
            const Grid& grid,
            const ArrayHeader& array,
            const VolumeWriteOptions& options)
      : path_(path),
        grid_(grid),
        array_(array),
        size_(array.components * static_cast<std::int64_t>(size_of(array.type))),
        is_nrrd_(has_extension(path, ".nrrd")),
        level_(options.compress),
        file_(path),
        descriptor_(open(file_.temporary().c_str(), O_WRONLY | O_CLOEXEC)) {
    const bool is_packed = level_ > 0;
    const std::string header =
        is_nrrd_ ? nrrd_header_text(grid, array.type, array.components, is_packed)
                 : meta_header_text(grid, array.type, array.components, is_packed);
    start_ = std::ssize(header);
    if (descriptor_ < 0 || !write_at(descriptor_, header.data(), header.size(), 0)) fail();
    if (is_packed) scratch_.emplace(path);
    // Samples that nobody writes are zero.
    if (!is_packed && ftruncate(descriptor_, start_ + bytes()) != 0) fail();
  }
  ~ImageSink() override { close_file(); }

  void begin_step(double) override { refuse_steps(); }
  void repeat_step(double) override { refuse_steps(); }

  void write(std::size_t, const Region& region, const void* samples) override {
    const auto* const in = static_cast<const std::byte*>(samples);
    const int descriptor = scratch_ ? scratch_->descriptor() : descriptor_;
    const std::int64_t start = scratch_ ? 0 : start_;
    std::vector<std::byte> turned;
    const bool is_written =
        for_each_run(grid_.dims, region, std::int64_t{1} << 16,
                     [&](std::int64_t in_grid, std::int64_t in_region, std::int64_t count) {
                       const std::byte* part = in + in_region * size_;
                       const auto bytes = static_cast<std::size_t>(count * size_);
                       if (array_.is_itk_field) {  // from RAS to LPS
                         turned.assign(part, part + bytes);
                         turn(turned);
                         part = turned.data();
                       }
                       return write_at(descriptor, part, bytes, start + in_grid * size_);
                     });
    if (!is_written) fail();
  }

  WrittenFile finish() override {
    if (scratch_) pack();
    if (!close_file()) fail();
    WrittenFile written;
    written.bytes = file_.finish();
    return written;
  }

 private:
  std::int64_t bytes() const { return grid_.voxel_count() * size_; }

  /// Negates the first two of three components.
  void turn(std::span<std::byte> samples) const {
    const std::size_t size = size_of(array_.type);
    for (std::size_t s = 0; s < samples.size() / size; ++s) {
      if (s % 3 < 2) negate_samples(array_.type, samples.subspan(s * size, size));
    }
  }

  [[noreturn]] void fail() const { throw_disk_error(path_); }
  [[noreturn]] void refuse_steps() const {
    throw IoError(path_, "", "holds no steps; write .nii.gz or .vtkhdf");
  }

  bool close_file() {
    if (descriptor_ < 0) return true;
    const bool is_closed = close(descriptor_) == 0;
    descriptor_ = -1;
    return is_closed;
  }

  /// NRRD has gzip's format, MetaImage zlib's.
  void pack() {
    z_stream stream{};
    const int window = 15 + (is_nrrd_ ? 16 : 0);
    constexpr int memory = 8;
    if (deflateInit2(&stream, level_, Z_DEFLATED, window, memory, Z_DEFAULT_STRATEGY) != Z_OK) {
      throw IoError(path_, "", "cannot be packed: zlib has no memory");
    }
    std::vector<Bytef> plain(nifti_part_bytes), packed(nifti_part_bytes);
    std::int64_t done = 0, at = start_;
    bool is_sound = true;
    for (int state = Z_OK; state != Z_STREAM_END && is_sound;) {
      if (stream.avail_in == 0 && done < bytes()) {
        const auto count =
            static_cast<std::size_t>(std::min<std::int64_t>(std::ssize(plain), bytes() - done));
        is_sound = read_at(scratch_->descriptor(), plain.data(), count, done);
        done += static_cast<std::int64_t>(count);
        stream.next_in = plain.data();
        stream.avail_in = static_cast<uInt>(count);
      }
      stream.next_out = packed.data();
      stream.avail_out = static_cast<uInt>(packed.size());
      state = deflate(&stream, done < bytes() ? Z_NO_FLUSH : Z_FINISH);
      const std::size_t count = packed.size() - stream.avail_out;
      is_sound = is_sound && write_at(descriptor_, packed.data(), count, at);
      at += static_cast<std::int64_t>(count);
    }
    deflateEnd(&stream);
    if (!is_sound) fail();
    scratch_.reset();
  }

  std::string path_;
  Grid grid_;
  ArrayHeader array_;
  std::int64_t size_;  // of a voxel
  bool is_nrrd_;
  int level_;
  FinishedFile file_;
  int descriptor_;
  std::int64_t start_ = 0;  // of the samples
  std::optional<ScratchFile> scratch_;
};
}  // namespace

bool has_image_name(const std::string& path) {
  return has_extension(path, ".nrrd") || has_extension(path, ".mha");
}

std::unique_ptr<VolumeSink> make_image_sink(const std::string& path,
                                            const Grid& grid,
                                            const std::vector<ArrayHeader>& arrays,
                                            const VolumeWriteOptions& options,
                                            bool is_temporal) {
  const ArrayHeader& array = only_array(path, "an image of this format", grid, arrays);
  if (is_temporal) throw IoError(path, "", "holds no steps; write .nii.gz or .vtkhdf");
  return std::make_unique<ImageSink>(path, grid, array, options);
}

}  // namespace tetwarp
