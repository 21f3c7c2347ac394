/// @file image_write.cpp
/// A header, then the samples in place, or packed when all are there.
#include "io/image/image_write.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>
#include <tetwarp/itk_space.hpp>
#include <vector>

#include "io/files/extension.hpp"
#include "io/files/finished_file.hpp"
#include "io/files/scratch_file.hpp"
#include "io/files/sink_checks.hpp"
#include "io/image/meta_header.hpp"
#include "io/image/mgh_header.hpp"
#include "io/image/nrrd_header.hpp"
#include "io/nifti/nifti_components.hpp"
#include "io/nifti/nifti_header.hpp"
#include "io/nifti/nifti_runs.hpp"

namespace tetwarp {
namespace {
/// Formats by the end of a name.
enum class ImageFormat { nrrd, meta, meta_pair, mgh };

std::optional<ImageFormat> format_of(const std::string& path) {
  if (has_extension(path, ".nrrd")) return ImageFormat::nrrd;
  if (has_extension(path, ".mha")) return ImageFormat::meta;
  if (has_extension(path, ".mhd")) return ImageFormat::meta_pair;
  if (has_extension(path, ".mgh") || has_extension(path, ".mgz")) return ImageFormat::mgh;
  return std::nullopt;
}

/// The file that holds the samples: of a pair .mhd and .raw the second one, else the file itself.
std::string samples_of(const std::string& path, bool is_packed) {
  if (format_of(path) != ImageFormat::meta_pair) return path;
  const std::string stem = path.substr(0, path.size() - std::string(".mhd").size());
  const std::string samples = stem + (is_packed ? ".zraw" : ".raw");
  std::error_code error;
  if (std::filesystem::exists(samples, error) && !std::filesystem::exists(path, error)) {
    throw IoError(path, "",
                  "its samples would replace '" + samples + "'; name another file, or remove it");
  }
  return samples;
}

/// @throws IoError  when the format cannot hold the image
std::string header_text_of(const std::string& path, ImageHeader header) {
  const ImageFormat format = *format_of(path);
  header.steps = std::max<std::int64_t>(1, std::ssize(header.times));
  try {
    return format == ImageFormat::nrrd  ? nrrd_header_text(header)
           : format == ImageFormat::mgh ? mgh_header_text(header)
                                        : meta_header_text(header);
  } catch (const std::invalid_argument& error) {
    throw IoError(path, "", error.what());
  }
}

/// The header without the times of the steps, which are not known yet.
ImageHeader header_of(const std::string& path,
                      const Grid& grid,
                      const ArrayHeader& array,
                      int level) {
  ImageHeader header;
  // These formats hold millimeters. ITK, which reads NRRD and MetaImages, has images of NIfTI
  // headers without a form elsewhere than FreeSurfer.
  header.grid = grid;
  if (array.nifti) {
    const double unit = nifti_length_unit(array.nifti->xyzt_units);
    const bool is_of_itk = format_of(path) != ImageFormat::mgh;
    header.grid = scaled(grid, is_of_itk ? itk_factor(*array.nifti) : Point3{unit, unit, unit});
  }
  header.type = array.type;
  header.components = array.components;
  if (array.is_itk_field) {
    header.field_type = array.name == "tetwarp_forward" ? "modeling" : "resampling";
  }
  header.is_packed = level > 0;
  const std::string samples = samples_of(path, header.is_packed);
  if (samples != path) header.data_file = std::filesystem::path(samples).filename().string();
  static_cast<void>(header_text_of(path, header));
  return header;
}

/// Of deflate: .mgz is packed, .mgh is not.
int level_of(const std::string& path, const VolumeWriteOptions& options) {
  if (format_of(path) != ImageFormat::mgh) return options.compress;
  return has_extension(path, ".mgz") ? std::max(options.compress, 1) : 0;
}

/// Factors of an array's components, as the file holds them: displacement fields along LPS axes in
/// millimeters, vectors and tensors along their NiftiFacts' axes. Nothing: the file holds the
/// numbers of the array.
/// @throws IoError  what cannot be turned
std::optional<std::array<double, 9>> factors_of(const std::string& path,
                                                const Grid& grid,
                                                const ArrayHeader& array) {
  const NiftiFacts facts = array.nifti.value_or(default_nifti_facts(array.components));
  if (!array.is_itk_field && facts.component_axes == Axes::ras) return std::nullopt;
  const bool has_form = facts.sform_code > 0 || facts.qform_code > 0;
  const ComponentMap map = array.is_itk_field
                               ? itk_field_map(path, array.type, array.components, grid, has_form,
                                               nifti_length_unit(facts.xyzt_units))
                               : image_component_map(path, array.type, array.components, Axes::lps);
  std::array<double, 9> factors{};
  for (std::size_t c = 0; c < factors.size(); ++c) {
    factors[c] = map.is_negated[c] ? -map.scale : map.scale;
  }
  return factors;
}

class ImageSink : public VolumeSink {
 public:
  ImageSink(const std::string& path,
            const Grid& grid,
            const ArrayHeader& array,
            const VolumeWriteOptions& options,
            bool is_temporal)
      : path_(path),
        format_(*format_of(path)),
        factors_(factors_of(path, grid, array)),
        is_temporal_(is_temporal),
        level_(level_of(path, options)),
        header_(header_of(path, grid, array, level_)) {
    file_.emplace(samples_of(path, header_.is_packed));
    descriptor_ = open(file_->temporary().c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) fail();
    if (header_.is_packed || is_temporal) {
      scratch_.emplace(path);
      return;
    }
    write_header();
    // Samples that nobody writes are zero.
    if (ftruncate(descriptor_, start_ + bytes()) != 0) fail();
  }
  ~ImageSink() override { close_file(); }

  void begin_step(double time) override { header_.times.push_back(time); }

  void repeat_step(double time) override {
    std::vector<std::byte> part(nifti_part_bytes);
    const std::int64_t to = std::ssize(header_.times) * step_bytes(), from = to - step_bytes();
    for (std::int64_t done = 0; done < step_bytes();) {
      const auto count =
          static_cast<std::size_t>(std::min<std::int64_t>(std::ssize(part), step_bytes() - done));
      if (!read_at(scratch_->descriptor(), part.data(), count, from + done) ||
          !write_at(scratch_->descriptor(), part.data(), count, to + done)) {
        fail();
      }
      done += static_cast<std::int64_t>(count);
    }
    header_.times.push_back(time);
  }

  void write(std::size_t, const Region& region, const void* samples) override {
    const auto* const in = static_cast<const std::byte*>(samples);
    const int descriptor = scratch_ ? scratch_->descriptor() : descriptor_;
    const std::int64_t step = is_temporal_ ? std::ssize(header_.times) - 1 : 0;
    const std::int64_t start = (scratch_ ? 0 : start_) + step * step_bytes();
    const auto size = static_cast<std::int64_t>(header_.voxel_bytes());
    std::vector<std::byte> turned;
    const bool is_written =
        for_each_run(header_.grid.dims, region, std::int64_t{1} << 16,
                     [&](std::int64_t in_grid, std::int64_t in_region, std::int64_t count) {
                       const std::byte* part = in + in_region * size;
                       const auto bytes = static_cast<std::size_t>(count * size);
                       if (factors_ || format_ == ImageFormat::mgh) {
                         turned.assign(part, part + bytes);
                         turn(turned);
                         part = turned.data();
                       }
                       return write_at(descriptor, part, bytes, start + in_grid * size);
                     });
    if (!is_written) fail();
  }

  WrittenFile finish() override {
    if (scratch_) {
      // Of blocks that nobody wrote the samples are zero.
      if (ftruncate(scratch_->descriptor(), bytes()) != 0) fail();
      if (!header_.is_packed) {
        write_header();
        copy();
      } else {
        if (format_ != ImageFormat::mgh) write_header();
        pack();
      }
    }
    if (!close_file()) fail();
    WrittenFile written;
    written.bytes = file_->finish();
    if (format_ == ImageFormat::meta_pair)
      written.bytes += write_finished_file(path_, header_text());
    return written;
  }

 private:
  std::int64_t step_bytes() const {
    return header_.grid.voxel_count() * static_cast<std::int64_t>(header_.voxel_bytes());
  }
  std::int64_t bytes() const {
    return step_bytes() * (is_temporal_ ? std::ssize(header_.times) : 1);
  }

  std::string header_text() const { return header_text_of(path_, header_); }

  /// Writes the header where it is the beginning of the file.
  void write_header() {
    if (format_ == ImageFormat::meta_pair) return;
    const std::string text = header_text();
    start_ = std::ssize(text);
    if (!write_at(descriptor_, text.data(), text.size(), 0)) fail();
  }

  /// Samples as they are stored: with their factors, of FreeSurfer's images in big-endian order.
  void turn(std::span<std::byte> samples) const {
    const std::size_t size = size_of(header_.type);
    for (std::size_t s = 0; s < samples.size() / size; ++s) {
      const std::span<std::byte> sample = samples.subspan(s * size, size);
      const std::size_t component = s % static_cast<std::size_t>(header_.components);
      if (factors_ && (*factors_)[component] != 1) {
        scale_samples(header_.type, (*factors_)[component], sample);
      }
      const bool is_little = std::endian::native == std::endian::little;
      if (format_ == ImageFormat::mgh && is_little) std::ranges::reverse(sample);
    }
  }

  [[noreturn]] void fail() const { throw_disk_error(path_); }

  bool close_file() {
    if (descriptor_ < 0) return true;
    const bool is_closed = close(descriptor_) == 0;
    descriptor_ = -1;
    return is_closed;
  }

  /// Copies all steps behind the header.
  void copy() {
    std::vector<std::byte> part(nifti_part_bytes);
    for (std::int64_t done = 0; done < bytes();) {
      const auto count =
          static_cast<std::size_t>(std::min<std::int64_t>(std::ssize(part), bytes() - done));
      if (!read_at(scratch_->descriptor(), part.data(), count, done) ||
          !write_at(descriptor_, part.data(), count, start_ + done)) {
        fail();
      }
      done += static_cast<std::int64_t>(count);
    }
    scratch_.reset();
  }

  /// Packs the samples behind the header, MetaImages in zlib's format, NRRD in gzip's. Of
  /// FreeSurfer's images header and samples are one gzip stream.
  void pack() {
    z_stream stream{};
    const bool is_gzip = format_ == ImageFormat::nrrd || format_ == ImageFormat::mgh;
    const int window = 15 + (is_gzip ? 16 : 0);
    constexpr int memory = 8;
    if (deflateInit2(&stream, level_, Z_DEFLATED, window, memory, Z_DEFAULT_STRATEGY) != Z_OK) {
      throw IoError(path_, "", "cannot be packed: zlib has no memory");
    }
    std::vector<Bytef> plain(nifti_part_bytes), packed(nifti_part_bytes);
    if (format_ == ImageFormat::mgh) {
      const std::string text = header_text();
      std::ranges::copy(text, plain.begin());
      stream.next_in = plain.data();
      stream.avail_in = static_cast<uInt>(text.size());
    }
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
  ImageFormat format_;
  std::optional<std::array<double, 9>> factors_;  ///< by component
  bool is_temporal_;
  int level_;
  ImageHeader header_;
  std::optional<FinishedFile> file_;  // that holds the samples
  int descriptor_ = -1;
  std::int64_t start_ = 0;  // of the samples
  std::optional<ScratchFile> scratch_;
};
}  // namespace

bool has_image_name(const std::string& path) {
  return format_of(path).has_value();
}

void check_image(const std::string& path,
                 const Grid& grid,
                 const std::vector<ArrayHeader>& arrays,
                 const VolumeWriteOptions& options) {
  const ArrayHeader& array = only_array(path, "an image of this format", grid, arrays);
  static_cast<void>(factors_of(path, grid, array));
  static_cast<void>(header_of(path, grid, array, level_of(path, options)));
}

std::unique_ptr<VolumeSink> make_image_sink(const std::string& path,
                                            const Grid& grid,
                                            const std::vector<ArrayHeader>& arrays,
                                            const VolumeWriteOptions& options,
                                            bool is_temporal) {
  const ArrayHeader& array = only_array(path, "an image of this format", grid, arrays);
  return std::make_unique<ImageSink>(path, grid, array, options, is_temporal);
}

}  // namespace tetwarp
