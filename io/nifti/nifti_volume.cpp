/// @file nifti_volume.cpp
/// NIfTI files as volumes.
#include "io/nifti/nifti_volume.hpp"

#include <tetwarp/io.hpp>
#include <utility>

#include "io/files/volume_source.hpp"
#include "io/nifti/nifti_samples.hpp"

namespace tetwarp {
namespace {
const std::string array_name = Volume{}.name;

ArrayHeader array_of(const NiftiHeader& header, Axes axes) {
  NiftiFacts facts = header.facts;
  facts.component_axes = axes;
  return {array_name, header.value_type(), header.components, facts};
}

class NiftiSource : public VolumeSource {
 public:
  NiftiSource(const std::string& path, std::int64_t step, const VolumeReadOptions& options)
      : samples_(path, read_nifti_header(path), step, options.axes, options.scratch),
        array_(array_of(samples_.header(), options.axes)) {}

  const Grid& grid() const override { return samples_.header().grid; }
  const ArrayHeader& array() const override { return array_; }
  std::vector<std::string> array_names() const override { return {array_.name}; }
  double chunk_bytes() const override { return samples_.buffer_bytes(); }
  double unpacked_bytes() const override { return samples_.unpacked_bytes(); }
  void read(const Region& region, void* samples) override { samples_.read(region, samples); }

 private:
  NiftiSamples samples_;
  ArrayHeader array_;
};
}  // namespace

VolumeHeader read_nifti_volume_header(const std::string& path, const VolumeReadOptions& options) {
  const NiftiHeader header = read_nifti_header(path);
  VolumeHeader volume;
  volume.grid = header.grid;
  volume.arrays = {array_of(header, options.axes)};
  volume.active = array_name;
  volume.times = header.times;
  volume.left_out = header.left_out;
  return volume;
}

std::unique_ptr<VolumeSource> open_nifti_source(const std::string& path,
                                                const std::string& array,
                                                std::int64_t step,
                                                const VolumeReadOptions& options) {
  if (!array.empty() && array != array_name) {
    throw IoError(path, array, "no such array; a NIfTI image has one, called " + array_name);
  }
  return std::make_unique<NiftiSource>(path, step, options);
}

NiftiFacts read_nifti_facts(const std::string& path, Axes axes) {
  return *array_of(read_nifti_header(path), axes).nifti;
}

Volume read_nifti(const std::string& path, Axes axes, std::int64_t step) {
  static_cast<void>(read_nifti_header(path));  // a file of another format is an error
  return read_volume(path, array_name, step, {.axes = axes});
}

}  // namespace tetwarp
