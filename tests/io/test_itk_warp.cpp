/// @file test_itk_warp.cpp
/// Displacement fields as ITK reads them: its filter gives the same warp.
#include <gtest/gtest.h>
#include <itkImage.h>
#include <itkImageFileReader.h>
#include <itkNiftiImageIO.h>
#include <itkVector.h>
#include <itkWarpImageFilter.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/field_buffers.hpp"
#include "tests/support/io_files.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
using Image = itk::Image<float, 3>;
using Field = itk::Image<itk::Vector<float, 3>, 3>;

template <class Type>
typename Type::Pointer read_by_itk(const std::string& path) {
  const auto reader = itk::ImageFileReader<Type>::New();
  reader->SetImageIO(itk::NiftiImageIO::New());
  reader->SetFileName(path);
  reader->Update();
  return reader->GetOutput();
}

/// An oblique source, an output grid of other axes and spacing, a waved mesh. ITK adds what a file
/// keeps in float32 in another order: positions are good to 1e-5 voxel, of samples below 1 with
/// slopes of at most 1/8 per axis. Found: 8.3e-7.
TEST(ItkWarp, ResamplingByTheExportedFieldIsTheWarp) {
  const ScratchFolder folder;
  const Grid source_grid = scenes::oblique_grid(24, 20, 22);
  Grid output_grid = source_grid;
  output_grid.dims = {20, 26, 17};
  output_grid.spacing = {0.9 * source_grid.spacing[0], 0.8 * source_grid.spacing[1],
                         1.1 * source_grid.spacing[2]};
  output_grid.direction = {0, -1, 0, 0.6, 0, -0.8, 0.8, 0, 0.6};
  const Point3 center = source_grid.world_of({12, 10, 11});
  const Point3 half = output_grid.world_of({10, 13, 8});
  for (std::size_t axis = 0; axis < 3; ++axis)
    output_grid.origin[axis] += center[axis] - half[axis];
  const Volume source = scenes::wavy_volume(source_grid, PixelType::float32);
  const Mesh mesh = covering_mesh(source_grid);
  const std::vector<Point3> deformed =
      scenes::waved(mesh.rest_positions, 1.5 * source_grid.spacing[0], 7);
  Warper warper(source, mesh, {.output_grid = output_grid, .backend = Backend::cpu});
  Volume warped = make_volume(output_grid, PixelType::float32);
  Volume field = make_volume(output_grid, PixelType::float32, 3);
  std::vector<std::uint8_t> mask(warped.samples<float>().size());
  void* const data = warped.data.data();
  warper.step(deformed, {.volumes = {&data, 1},
                         .mask = mask.data(),
                         .fields = {.displacement = field.samples<float>().data()}});

  write_nifti(folder / "source.nii", source);
  write_nifti(folder / "field.nii.gz", field, Axes::lps);
  const auto filter = itk::WarpImageFilter<Image, Image, Field>::New();
  const Field::Pointer displacement = read_by_itk<Field>(folder / "field.nii.gz");
  filter->SetInput(read_by_itk<Image>(folder / "source.nii"));
  filter->SetDisplacementField(displacement);
  filter->SetOutputParametersFromImage(displacement);
  filter->SetEdgePaddingValue(-1);
  filter->Update();
  const float* const resampled = filter->GetOutput()->GetBufferPointer();

  double worst = 0;
  std::size_t compared = 0;
  for (std::size_t v = 0; v < mask.size(); ++v) {
    if (mask[v] == 0 || resampled[v] == -1)
      continue;  // there ITK's image ends half a voxel earlier
    ++compared;
    worst = std::max(worst, std::abs(double{resampled[v]} - warped.samples<float>()[v]));
  }
  RecordProperty("worst_in_1e-9", static_cast<int>(1e9 * worst));
  EXPECT_LE(worst, 1e-5 * 3 / 8 + 1e-6);
  EXPECT_GT(compared, mask.size() / 4);
}
}  // namespace
}  // namespace tetwarp::test
