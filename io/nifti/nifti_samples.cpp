/// @file nifti_samples.cpp
/// Reads plain and packed samples, swaps their bytes, and scales them.
#include "io/nifti/nifti_samples.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <optional>
#include <tetwarp/error.hpp>
#include <utility>
#include <vector>

#include "host/base/pixel_dispatch.hpp"
#include "io/files/read_check.hpp"
#include "io/nifti/nifti_runs.hpp"

namespace tetwarp {
namespace {
/// Device, inode, size and time of change of a file. They differ when the file was replaced or
/// written.
struct FileIdentity {
  dev_t device = 0;
  ino_t node = 0;
  off_t size = 0;
  timespec changed{};

  bool operator==(const FileIdentity& other) const {
    return device == other.device && node == other.node && size == other.size &&
           changed.tv_sec == other.changed.tv_sec && changed.tv_nsec == other.changed.tv_nsec;
  }
};

FileIdentity identity_of(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return {};
  return {status.st_dev, status.st_ino, status.st_size, status.st_mtim};
}

/// The gzip file that was read last stays open: the next step of a series follows in it, and is
/// reached without reading the steps before it again.
struct KeptStream {
  std::mutex lock;
  FileIdentity identity;
  std::unique_ptr<NiftiStream> stream;
};

KeptStream& kept() {
  static KeptStream stream;
  return stream;
}

std::unique_ptr<NiftiStream> take_stream(const std::string& path) {
  KeptStream& last = kept();
  const std::lock_guard guard(last.lock);
  if (last.stream && last.identity == identity_of(path)) return std::move(last.stream);
  last.stream.reset();
  return std::make_unique<NiftiStream>(path, "rb", true);
}

void keep_stream(const std::string& path, std::unique_ptr<NiftiStream> stream) {
  KeptStream& last = kept();
  const std::lock_guard guard(last.lock);
  last.identity = identity_of(path);
  last.stream = std::move(stream);
}

template <std::size_t size>
void swap_each(std::byte* samples, std::size_t count) {
  for (std::size_t s = 0; s < count; ++s)
    std::reverse(samples + s * size, samples + (s + 1) * size);
}

void swap_samples(std::size_t size, std::byte* samples, std::size_t count) {
  if (size == 2) swap_each<2>(samples, count);
  if (size == 4) swap_each<4>(samples, count);
  if (size == 8) swap_each<8>(samples, count);
}

/// Stores slope * sample + intercept, or its negative, in every `stride`-th value.
/// @returns false when finite samples become infinite
template <class Value>
bool scale(const NiftiHeader& header,
           bool is_negated,
           const std::byte* samples,
           std::size_t count,
           std::byte* out,
           std::size_t stride) {
  bool all_fit = true;
  with_pixel_type(header.type, [&]<class T>(T) {
    for (std::size_t v = 0; v < count; ++v) {
      T sample;
      std::memcpy(&sample, samples + v * sizeof sample, sizeof sample);
      double scaled = header.slope * static_cast<double>(sample) + header.intercept;
      if (is_negated) scaled = 0 - scaled;
      const auto value = static_cast<Value>(scaled);
      all_fit &= std::isfinite(value) || !std::isfinite(static_cast<double>(sample));
      std::memcpy(out + v * stride * sizeof value, &value, sizeof value);
    }
  });
  return all_fit;
}
}  // namespace

/// Bytes of the samples at offsets that grow: of an open file, or of a gzip file.
class NiftiSamples::Source {
 public:
  explicit Source(int descriptor) : descriptor_(descriptor) {}
  /// @param end  offset behind the last sample of all steps
  Source(const std::string& path, bool is_gzip, std::int64_t end) : path_(path), end_(end) {
    if (is_gzip) {
      stream_ = take_stream(path);
    } else {
      descriptor_ = owned_ = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    }
  }
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  ~Source() {
    if (owned_ >= 0) close(owned_);
    if (stream_ && *stream_) keep_stream(path_, std::move(stream_));
  }

  /// @param out  has room for one byte more
  /// @returns false when the bytes are not there, or a gzip file is damaged behind the last sample
  bool read(std::int64_t offset, void* out, std::size_t bytes) {
    check_read();
    if (!stream_) return descriptor_ >= 0 && read_at(descriptor_, out, bytes, offset);
    if (!*stream_ || !reach(offset)) return false;
    const bool is_last = offset + static_cast<std::int64_t>(bytes) == end_;
    return is_last ? stream_->read_last(out, bytes) : stream_->read(out, bytes);
  }

 private:
  /// Goes on to an offset part by part: what is skipped is unpacked, too.
  bool reach(std::int64_t offset) {
    constexpr std::int64_t part = nifti_part_bytes;
    for (std::byte last; offset - stream_->position() > part; check_read()) {
      if (!stream_->seek(stream_->position() + part - 1) || !stream_->read(&last, 1)) return false;
    }
    return stream_->seek(offset);
  }

  std::string path_;
  std::int64_t end_ = 0;
  int descriptor_ = -1;
  int owned_ = -1;
  std::unique_ptr<NiftiStream> stream_;
};

NiftiSamples::NiftiSamples(
    std::string path, NiftiHeader header, std::int64_t step, Axes axes, std::string scratch)
    : path_(std::move(path)),
      header_(std::move(header)),
      step_(step),
      scratch_(std::move(scratch)),
      map_(component_map(
          path_, header_.value_type(), header_.components, header_.facts.intent_code, axes)) {
  if (step >= 0 && step < header_.steps) return;
  throw IoError(path_, "",
                "has no step " + std::to_string(step) + ", its steps are " +
                    (header_.steps == 1 ? "0 alone" : "0 to " + std::to_string(header_.steps - 1)));
}

NiftiSamples::~NiftiSamples() = default;

std::int64_t NiftiSamples::plane_count() const {
  return header_.is_interleaved ? 1 : header_.components;
}

std::size_t NiftiSamples::plane_voxel_bytes() const {
  return size_of(header_.type) *
         static_cast<std::size_t>(header_.is_interleaved ? header_.components : 1);
}

std::int64_t NiftiSamples::plane_bytes() const {
  return header_.grid.voxel_count() * static_cast<std::int64_t>(plane_voxel_bytes());
}

std::int64_t NiftiSamples::end_offset() const {
  return header_.data_offset + plane_count() * header_.steps * plane_bytes();
}

/// The file stores all steps of one component, then those of the next one.
std::int64_t NiftiSamples::plane_offset(std::size_t component) const {
  const std::int64_t plane = static_cast<std::int64_t>(component) * header_.steps + step_;
  return header_.data_offset + plane * plane_bytes();
}

double NiftiSamples::buffer_bytes() const {
  // A part of the samples, and the window and buffers of zlib.
  return static_cast<double>(nifti_part_bytes + (header_.is_gzip ? 1 << 17 : 0));
}

double NiftiSamples::unpacked_bytes() const {
  return header_.is_gzip ? static_cast<double>(plane_bytes() * plane_count()) : 0;
}

void NiftiSamples::fail() const {
  throw IoError(path_, "",
                "ends early or has a wrong checksum: truncated or damaged, copy it again");
}

void NiftiSamples::read(const Region& region, void* out) {
  const bool is_whole = region == Region{{0, 0, 0}, header_.grid.dims};
  if (header_.is_gzip && !is_whole && !unpacked_) unpack();
  read_in_order(region, out);
}

void NiftiSamples::read_in_order(const Region& region, void* out) const {
  std::optional<Source> source;
  if (unpacked_) {
    source.emplace(unpacked_->descriptor());
  } else {
    source.emplace(header_.samples, header_.is_gzip, end_offset());
  }
  for (std::size_t c = 0; c < static_cast<std::size_t>(plane_count()); ++c) {
    read_component(*source, region, c, static_cast<std::byte*>(out));
  }
}

void NiftiSamples::unpack() {
  const std::string folder = scratch_.empty() ? std::filesystem::temp_directory_path() / "unpacked"
                                              : std::filesystem::path(scratch_);
  auto unpacked = std::make_unique<ScratchFile>(folder);
  Source source(header_.samples, true, end_offset());
  std::vector<std::byte> part(nifti_part_bytes + 1);
  for (std::size_t c = 0; c < static_cast<std::size_t>(plane_count()); ++c) {
    for (std::int64_t done = 0; done < plane_bytes();) {
      const auto bytes = std::min(std::ssize(part) - 1, plane_bytes() - done);
      const auto count = static_cast<std::size_t>(bytes);
      if (!source.read(plane_offset(c) + done, part.data(), count)) fail();
      const std::int64_t to = static_cast<std::int64_t>(c) * plane_bytes() + done;
      if (!write_at(unpacked->descriptor(), part.data(), count, to)) {
        throw IoError(path_, "",
                      std::string("cannot be unpacked beside the output: ") + std::strerror(errno) +
                          "; free disk space, or unpack it yourself (gunzip)");
      }
      done += bytes;
    }
  }
  unpacked_ = std::move(unpacked);
}

void NiftiSamples::read_component(Source& source,
                                  const Region& region,
                                  std::size_t c,
                                  std::byte* out) const {
  const std::size_t size = plane_voxel_bytes();
  const std::size_t voxel =
      size_of(header_.value_type()) * static_cast<std::size_t>(header_.components);
  const std::int64_t start =
      unpacked_ ? static_cast<std::int64_t>(c) * plane_bytes() : plane_offset(c);
  std::vector<std::byte> part;
  const auto read_run = [&](std::int64_t in_grid, std::int64_t in_region, std::int64_t count) {
    const auto samples = static_cast<std::size_t>(count);
    part.resize(samples * size + 1);
    const std::int64_t offset = start + in_grid * static_cast<std::int64_t>(size);
    if (!source.read(offset, part.data(), samples * size)) return false;
    convert(part.data(), samples, c, out + static_cast<std::size_t>(in_region) * voxel);
    return true;
  };
  const auto most = static_cast<std::int64_t>(nifti_part_bytes / size);
  if (!for_each_run(header_.grid.dims, region, most, read_run)) fail();
}

/// Stores samples of the file as the values of a component. @param part  is changed
void NiftiSamples::convert(std::byte* part,
                           std::size_t count,
                           std::size_t c,
                           std::byte* out) const {
  const std::size_t size = plane_voxel_bytes();
  if (header_.is_interleaved) return copy_strided(part, 1, out, 1, size, count);
  const auto components = static_cast<std::size_t>(header_.components);
  if (header_.is_swapped) swap_samples(size, part, count);
  const bool is_negated = map_.is_negated[c];
  std::byte* const to = out + map_.place[c] * size_of(header_.value_type());
  if (!header_.is_scaled()) {
    if (is_negated) negate_samples(header_.type, {part, count * size});
    copy_strided(part, 1, to, components, size, count);
    return;
  }
  const bool is_double = header_.value_type() == PixelType::float64;
  if (is_double ? scale<double>(header_, is_negated, part, count, to, components)
                : scale<float>(header_, is_negated, part, count, to, components)) {
    return;
  }
  throw IoError(path_, "scl_slope",
                std::string("and scl_inter make samples larger than ") +
                    (is_double ? "float64" : "float32") + " holds; correct the header");
}

}  // namespace tetwarp
