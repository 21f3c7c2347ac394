#include <itkImage.h>
#include <itkLinearInterpolateImageFunction.h>
#include <itkMultiThreaderBase.h>
#include <itkWarpImageFilter.h>

#include "bench/peers/peer.hpp"

namespace tetwarp::bench {
namespace {
using FloatImage = itk::Image<float, 3>;
using Field = itk::Image<itk::Vector<float, 3>, 3>;
using Warp = itk::WarpImageFilter<FloatImage, FloatImage, Field>;

/// An image over memory that the caller keeps.
template <class Image>
typename Image::Pointer image_over(typename Image::PixelType* pixels,
                                   const std::array<int, 3>& dims) {
  typename Image::SizeType size;
  std::size_t count = 1;
  for (unsigned axis = 0; axis < 3; ++axis) {
    size[axis] = static_cast<itk::SizeValueType>(dims[axis]);
    count *= size[axis];
  }
  typename Image::RegionType region;
  region.SetSize(size);
  auto image = Image::New();
  image->SetRegions(region);
  image->GetPixelContainer()->SetImportPointer(pixels, count, false);
  return image;
}
}  // namespace

PeerStep itk_warp(const PeerInput& input) {
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(
      static_cast<itk::ThreadIdType>(input.threads));
  auto* const vectors = reinterpret_cast<Field::PixelType*>(const_cast<float*>(input.displacement));
  auto filter = Warp::New();
  filter->SetInterpolator(itk::LinearInterpolateImageFunction<FloatImage, double>::New());
  filter->SetInput(image_over<FloatImage>(const_cast<float*>(input.source), input.source_dims()));
  filter->SetDisplacementField(image_over<Field>(vectors, input.output_dims()));
  filter->SetOutputOrigin(itk::Point<double, 3>(0.0));
  filter->SetOutputSpacing(itk::Vector<double, 3>(1.0));
  filter->SetEdgePaddingValue(0);
  filter->SetNumberOfWorkUnits(
      static_cast<itk::ThreadIdType>(input.threads > 1 ? 4 * input.threads : 1));
  return [filter, input] {
    auto output = image_over<FloatImage>(input.output, input.output_dims());
    filter->GraftOutput(output);
    filter->Modified();
    filter->Update();
  };
}

}  // namespace tetwarp::bench
