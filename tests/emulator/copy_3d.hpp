/// @file copy_3d.hpp
/// Copies of boxes between emulated device and host.
#pragma once
#include <cstddef>
#include <cstring>

#include "tests/emulator/runtime.hpp"

// NOLINTBEGIN(readability-identifier-naming): CUDA's own names
struct cudaPitchedPtr {
  void* ptr;
  std::size_t pitch, xsize, ysize;
};
struct cudaPos {
  std::size_t x, y, z;
};
struct cudaExtent {
  std::size_t width, height, depth;
};
struct cudaMemcpy3DParms {
  cudaPos srcPos, dstPos;
  cudaPitchedPtr srcPtr, dstPtr;
  cudaExtent extent;
  cudaMemcpyKind kind;
};
inline cudaPitchedPtr make_cudaPitchedPtr(void* data,
                                          std::size_t pitch,
                                          std::size_t xsize,
                                          std::size_t ysize) {
  return {data, pitch, xsize, ysize};
}
inline cudaExtent make_cudaExtent(std::size_t width, std::size_t height, std::size_t depth) {
  return {width, height, depth};
}

/// From the device to the host only, without positions.
inline cudaError_t cudaMemcpy3DAsync(const cudaMemcpy3DParms* parameters, cudaStream_t stream) {
  return tetwarp::simt::call(true, [&](auto& device) {
    const std::size_t width = parameters->extent.width, height = parameters->extent.height;
    const std::size_t depth = parameters->extent.depth;
    const cudaPitchedPtr from = parameters->srcPtr, to = parameters->dstPtr;
    const auto slice = [](const cudaPitchedPtr& array, std::size_t k) {
      return static_cast<std::byte*>(array.ptr) + k * array.ysize * array.pitch;
    };
    const std::size_t last = (height - 1) * from.pitch + width;
    if (parameters->kind != cudaMemcpyDeviceToHost || width > from.pitch || height > from.ysize ||
        !device.is_on_device(
            from.ptr, static_cast<std::size_t>(slice(from, depth - 1) - slice(from, 0)) + last)) {
      return cudaErrorInvalidValue;
    }
    device.note_copy(tetwarp::simt::ApiCall::copy_to_host, width * height * depth);
    tetwarp::simt::Stream& own = device.stream(stream);
    own.enqueue([=] {
      for (std::size_t k = 0; k < depth; ++k) {
        for (std::size_t j = 0; j < height; ++j) {
          std::memcpy(slice(to, k) + j * to.pitch, slice(from, k) + j * from.pitch, width);
        }
      }
    });
    if (!device.is_pinned(to.ptr, 1)) {
      device.note(tetwarp::simt::ApiCall::wait);
      own.run_until(own.queued);
    }
    device.run_eager();
    return cudaSuccess;
  });
}
// NOLINTEND(readability-identifier-naming)
