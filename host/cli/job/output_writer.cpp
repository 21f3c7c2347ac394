/// @file output_writer.cpp
/// Names of output files, and one writer for each.
#include "host/cli/job/output_writer.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "io/files/extension.hpp"
#include "io/volume/output_check.hpp"

namespace tetwarp::cli {
namespace {
bool is_displacement(const ArrayHeader& array) {
  return array.name == "tetwarp_displacement" || array.name == "tetwarp_forward";
}
}  // namespace

ArrayHeader nifti_array(ArrayHeader array, const std::optional<Axes>& axes) {
  NiftiFacts facts = array.nifti.value_or(default_nifti_facts(array.components));
  const bool is_field = is_displacement(array) && array.components == 3 && !is_integer(array.type);
  array.is_itk_field = is_field && axes != Axes::ras;
  facts.component_axes = array.is_itk_field ? Axes::lps : axes.value_or(facts.component_axes);
  // ITK turns displacements of this intent from RAS to LPS when it reads them.
  if (is_field && !array.is_itk_field) facts.intent_code = nifti_displacement_intent;
  array.nifti = facts;
  return array;
}

bool holds_one_array(const std::string& path) {
  return has_nifti_name(path) || has_image_name(path);
}

SplitName split_name(const std::string& path) {
  const std::string whole = ".nii.gz";
  const std::string extension = has_extension(path, whole)
                                    ? path.substr(path.size() - whole.size())
                                    : std::filesystem::path(path).extension().string();
  return {path.substr(0, path.size() - extension.size()), extension};
}

std::vector<std::string> files_of_output(const std::string& output,
                                         const std::vector<ArrayHeader>& arrays) {
  std::vector<std::string> files = {output};
  if (!holds_one_array(output)) return files;
  const SplitName name = split_name(output);
  for (std::size_t a = 1; a < arrays.size(); ++a) {
    const std::string prefix = "tetwarp_";
    const std::string& array = arrays[a].name;
    files.push_back(name.stem + "_" +
                    (array.starts_with(prefix) ? array.substr(prefix.size()) : array) +
                    name.extension);
  }
  return files;
}

void check_compress(const std::vector<std::string>& outputs, int level) {
  const auto is_plain = [](const std::string& output) {
    return has_extension(output, ".mgh") || has_vtk_image_name(output);
  };
  if (level == 0 || !std::ranges::all_of(outputs, is_plain)) return;
  throw std::invalid_argument(outputs.front() +
                              ": .mgh and .vti are not packed; leave out --compress, or write .mgz "
                              "or VTKHDF");
}

void check_output_arrays(const std::string& output,
                         const Grid& grid,
                         const std::vector<ArrayHeader>& arrays,
                         const VolumeWriteOptions& options,
                         bool is_temporal) {
  if (!holds_one_array(output)) {
    return check_volume_output(output, grid, arrays, options, is_temporal);
  }
  const std::vector<std::string> files = files_of_output(output, arrays);
  for (std::size_t a = 0; a < arrays.size(); ++a) {
    check_volume_output(files[a], grid, {nifti_array(arrays[a])}, options, is_temporal);
  }
}

OutputWriter::OutputWriter(const std::string& output,
                           const Grid& grid,
                           const std::vector<ArrayHeader>& arrays,
                           const VolumeWriteOptions& options,
                           bool is_temporal,
                           std::size_t changing,
                           ChunkShape chunks)
    : changing_(std::min(changing, arrays.size())) {
  if (!holds_one_array(output)) {
    files_.emplace_back(output, grid, arrays, options, is_temporal, chunks);
    return;
  }
  const std::vector<std::string> files = files_of_output(output, arrays);
  for (std::size_t a = 0; a < arrays.size(); ++a) {
    const std::vector<ArrayHeader> array = {nifti_array(arrays[a])};
    files_.emplace_back(files[a], grid, array, options, is_temporal && a < changing_, chunks);
  }
}

void OutputWriter::begin_step(double time) {
  ++steps_;
  for (std::size_t f = 0; f < files_.size() && f < changing_; ++f) files_[f].begin_step(time);
}

void OutputWriter::repeat_step(double time) {
  ++steps_;
  for (std::size_t f = 0; f < files_.size() && f < changing_; ++f) files_[f].repeat_step(time);
}

void OutputWriter::write(std::size_t array, const Region& region, const void* samples) {
  if (files_.size() == 1) {
    files_.front().write(array, region, samples);
  } else if (array < changing_ || steps_ <= 1) {
    files_[array].write(0, region, samples);
  }
}

WrittenFile OutputWriter::finish() {
  WrittenFile all;
  for (BlockVolumeWriter& file : files_) {
    const WrittenFile written = file.finish();
    all.bytes += written.bytes;
    all.chunks += written.chunks;
    all.chunks_background += written.chunks_background;
  }
  return all;
}

}  // namespace tetwarp::cli
