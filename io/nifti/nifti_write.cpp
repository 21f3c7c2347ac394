/// @file nifti_write.cpp
/// Writing NIfTI files: whole volumes, step by step, block by block.
#include "io/nifti/nifti_write.hpp"

#include <fcntl.h>
#include <nifti1.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "io/files/extension.hpp"
#include "io/files/finished_file.hpp"
#include "io/files/mean_interval.hpp"
#include "io/files/scratch_file.hpp"
#include "io/files/sink_checks.hpp"
#include "io/files/volume_sink.hpp"
#include "io/nifti/nifti_components.hpp"
#include "io/nifti/nifti_extension.hpp"
#include "io/nifti/nifti_facts.hpp"
#include "io/nifti/nifti_grid.hpp"
#include "io/nifti/nifti_header.hpp"
#include "io/nifti/nifti_runs.hpp"

namespace tetwarp {
namespace {
constexpr std::int64_t largest_dim_1 = 32767;  // of NIfTI-1

/// Facts of the file: those of the array or the defaults. ITK turns displacements of the intent
/// DISPVECT from RAS to LPS, whatever the header says.
NiftiFacts facts_of(const std::string& path, const ArrayHeader& array) {
  NiftiFacts facts = array.nifti.value_or(default_nifti_facts(array.components));
  if (const std::string problem = facts_problem(facts); !problem.empty()) {
    throw IoError(path, "", problem);
  }
  if (array.is_itk_field) facts.intent_code = NIFTI_INTENT_VECTOR;
  if (facts.component_axes == Axes::lps && facts.intent_code == nifti_displacement_intent) {
    facts.intent_code = NIFTI_INTENT_VECTOR;
  }
  return facts;
}

ComponentMap map_of(const std::string& path,
                    const Grid& grid,
                    const ArrayHeader& array,
                    const NiftiFacts& facts) {
  if (!array.is_itk_field) {
    return component_map(path, array.type, array.components, facts.intent_code,
                         facts.component_axes);
  }
  NiftiFields fields;
  set_grid(fields, grid, facts);
  return itk_field_map(path, array.type, array.components, grid,
                       fields.sform_code > 0 || fields.qform_code > 0,
                       nifti_length_unit(facts.xyzt_units));
}

/// A file of one step that is written whole goes to its place at once. Blocks and series go to a
/// temporary file first, because a gzip file can only be written from its beginning, and a series
/// has all steps of a component before the next component.
class NiftiSink : public VolumeSink {
 public:
  NiftiSink(const std::string& path,
            const Grid& grid,
            const ArrayHeader& array,
            const VolumeWriteOptions& options,
            bool is_temporal)
      : path_(path),
        grid_(grid),
        array_(array),
        facts_(facts_of(path, array)),
        options_(options),
        is_temporal_(is_temporal),
        map_(map_of(path, grid, array, facts_)),
        file_(path) {}

  void begin_step(double time) override {
    rows_.push_back(row_count_++);
    times_.push_back(time);
  }

  void repeat_step(double time) override {
    if (rows_.empty()) throw IoError(path_, "", "no step to repeat");
    rows_.push_back(rows_.back());
    times_.push_back(time);
  }

  void write(std::size_t, const Region& region, const void* samples) override {
    const auto* const bytes = static_cast<const std::byte*>(samples);
    const bool is_whole = region == Region{{0, 0, 0}, grid_.dims};
    if (!is_temporal_ && is_whole && !scratch_) {
      open_stream();
      for (std::size_t c = 0; c < components(); ++c) {
        write_component(region, c, bytes, [&](std::int64_t, std::span<const std::byte> part) {
          return stream_->write(part.data(), part.size());
        });
      }
      is_complete_ = true;
      return;
    }
    if (!scratch_) scratch_.emplace(path_);
    const std::int64_t row = is_temporal_ ? rows_.back() : 0;
    for (std::size_t c = 0; c < components(); ++c) {
      const std::int64_t start = plane_offset(row, c);
      write_component(region, c, bytes, [&](std::int64_t at, std::span<const std::byte> part) {
        return write_at(scratch_->descriptor(), part.data(), part.size(), start + at);
      });
    }
  }

  WrittenFile finish() override {
    if (is_temporal_ && rows_.empty()) throw IoError(path_, "", "no step was written");
    if (!is_complete_) {
      open_stream();
      copy_planes();
    }
    if (!stream_->close()) throw_disk_error(path_);
    stream_.reset();
    scratch_.reset();
    WrittenFile written;
    written.bytes = file_.finish();
    return written;
  }

 private:
  std::size_t components() const { return static_cast<std::size_t>(map_.count); }
  std::int64_t step_count() const { return is_temporal_ ? std::ssize(rows_) : 1; }
  std::int64_t plane_bytes() const {
    return grid_.voxel_count() * static_cast<std::int64_t>(size_of(array_.type));
  }
  /// Of a component at a row of the steps, in the temporary file.
  std::int64_t plane_offset(std::int64_t row, std::size_t component) const {
    return (row * map_.count + static_cast<std::int64_t>(component)) * plane_bytes();
  }

  NiftiFields make_fields() const {
    NiftiFields fields;
    fields.dim = {
        map_.count > 1 ? 5 : step_count() > 1 ? 4 : 3, 1, 1, 1, step_count(), map_.count, 1, 1};
    set_grid(fields, grid_, facts_);
    if (*std::ranges::max_element(fields.dim) > largest_dim_1) fields.version = 2;
    fields.datatype = nifti_datatype_of(array_.type);
    fields.bitpix = static_cast<std::int64_t>(8 * size_of(array_.type));
    fields.xyzt_units = facts_.xyzt_units;
    fields.intent_code = facts_.intent_code;
    fields.intent_p = facts_.intent_p;
    fields.intent_name = facts_.intent_name;
    fields.descrip = facts_.description;
    fields.cal_min = facts_.cal_min;
    fields.cal_max = facts_.cal_max;
    fields.pixdim[4] = facts_.time_step;
    fields.pixdim[5] = 1;
    const double unit = nifti_time_unit(facts_.xyzt_units);
    if (is_temporal_) fields.toffset = times_.front() / unit;
    if (step_count() > 1) fields.pixdim[4] = mean_interval(times_) / unit;
    return fields;
  }

  void open_stream() {
    NiftiFields fields = make_fields();
    const std::vector<char> extension = fingerprint_extension(options_.fingerprint);
    const std::size_t offset = fields.header_bytes() + 4 + extension.size();
    fields.vox_offset = static_cast<double>(offset);
    const bool is_compressed = has_extension(path_, ".gz");
    const std::string mode =
        "wb" + (is_compressed && options_.compress > 0 ? std::to_string(options_.compress) : "");
    stream_.emplace(file_.temporary(), mode.c_str(), is_compressed);
    const std::vector<char> header = encode_nifti(fields, !extension.empty());
    if (!*stream_ || !stream_->write(header.data(), header.size()) ||
        !stream_->write(extension.data(), extension.size())) {
      throw_disk_error(path_);
    }
  }

  /// Passes a component of a region to `put(offset in the plane, bytes)`, which returns false when
  /// that fails.
  template <class Put>
  void write_component(const Region& region, std::size_t c, const std::byte* samples, Put put) {
    const std::size_t size = size_of(array_.type);
    const auto stride = static_cast<std::size_t>(array_.components);
    const auto write_run = [&](std::int64_t in_grid, std::int64_t in_region, std::int64_t count) {
      part_.resize(static_cast<std::size_t>(count) * size);
      const std::byte* const in =
          samples + (static_cast<std::size_t>(in_region) * stride + map_.place[c]) * size;
      copy_strided(in, stride, part_.data(), 1, size, static_cast<std::size_t>(count));
      if (map_.is_negated[c]) negate_samples(array_.type, part_);
      if (map_.scale != 1) scale_samples(array_.type, map_.scale, part_);
      return put(in_grid * static_cast<std::int64_t>(size), std::span<const std::byte>(part_));
    };
    const auto most = static_cast<std::int64_t>(nifti_part_bytes / size);
    if (!for_each_run(grid_.dims, region, most, write_run)) {
      throw_disk_error(path_);
    }
  }

  /// From the temporary file: all steps of a component, then those of the next one.
  void copy_planes() {
    part_.resize(nifti_part_bytes);
    if (rows_.empty()) rows_.push_back(0);
    for (std::size_t c = 0; c < components(); ++c) {
      for (const std::int64_t row : rows_) {
        for (std::int64_t done = 0; done < plane_bytes();) {
          const auto count = std::min(std::ssize(part_), plane_bytes() - done);
          const auto bytes = static_cast<std::size_t>(count);
          if (!scratch_ ||
              !read_at(scratch_->descriptor(), part_.data(), bytes, plane_offset(row, c) + done) ||
              !stream_->write(part_.data(), bytes)) {
            throw_disk_error(path_);
          }
          done += count;
        }
      }
    }
  }

  std::string path_;
  Grid grid_;
  ArrayHeader array_;
  NiftiFacts facts_;
  VolumeWriteOptions options_;
  bool is_temporal_;
  ComponentMap map_;
  FinishedFile file_;
  std::optional<ScratchFile> scratch_;
  std::optional<NiftiStream> stream_;
  bool is_complete_ = false;  ///< all samples are in the stream
  std::int64_t row_count_ = 0;
  std::vector<std::int64_t> rows_;  ///< in the temporary file, one per step
  std::vector<double> times_;
  std::vector<std::byte> part_;
};
}  // namespace

bool has_nifti_name(const std::string& path) {
  return has_extension(path, ".nii") || has_extension(path, ".nii.gz");
}

void check_nifti(const std::string& path,
                 const Grid& grid,
                 const std::vector<ArrayHeader>& arrays) {
  const ArrayHeader& array = only_array(path, "a NIfTI image", grid, arrays);
  static_cast<void>(map_of(path, grid, array, facts_of(path, array)));
}

std::unique_ptr<VolumeSink> make_nifti_sink(const std::string& path,
                                            const Grid& grid,
                                            const std::vector<ArrayHeader>& arrays,
                                            const VolumeWriteOptions& options,
                                            bool is_temporal) {
  const ArrayHeader& array = only_array(path, "a NIfTI image", grid, arrays);
  return std::make_unique<NiftiSink>(path, grid, array, options, is_temporal);
}

void write_nifti(const std::string& path,
                 const Volume& volume,
                 Axes axes,
                 const std::optional<NiftiFacts>& given_facts) {
  if (!has_nifti_name(path)) {
    throw IoError(path, "", "the name of a NIfTI image must end in .nii or .nii.gz");
  }
  static_cast<void>(VolumeView(volume));  // checks that the samples fill the grid
  NiftiFacts facts = given_facts.value_or(default_nifti_facts(volume.components));
  facts.component_axes = axes;
  const ArrayHeader array{volume.name, volume.type, volume.components, facts};
  const auto sink = make_nifti_sink(path, volume.grid, {array}, {}, false);
  sink->write(0, {{0, 0, 0}, volume.grid.dims}, volume.data.data());
  sink->finish();
}

}  // namespace tetwarp
