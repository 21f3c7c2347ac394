#include "bench/measure/device_floors.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <memory>
#include <type_traits>
#include <vector>

#include "bench/measure/affine_device.cuh"
#include "kernels/exec/exec_cuda.cuh"

namespace tetwarp::bench {
namespace {
constexpr int repetitions = 9;

/// A stream and two events to time what runs on it.
class Clock {
 public:
  explicit Clock(int device) {
    check_cuda(cudaSetDevice(device), "cudaSetDevice");
    check_cuda(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking),
               "cudaStreamCreateWithFlags");
    check_cuda(cudaEventCreate(&begin_), "cudaEventCreate");
    check_cuda(cudaEventCreate(&end_), "cudaEventCreate");
  }
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;
  ~Clock() {
    cudaEventDestroy(begin_);
    cudaEventDestroy(end_);
    cudaStreamDestroy(stream_);
  }

  cudaStream_t stream() const { return stream_; }

  /// Sorted seconds of `repetitions` calls after two that do not count.
  std::array<double, repetitions> seconds_of(const std::function<void()>& work) const {
    std::array<double, repetitions> seconds{};
    for (int r = -2; r < repetitions; ++r) {
      check_cuda(cudaEventRecord(begin_, stream_), "cudaEventRecord");
      work();
      check_cuda(cudaEventRecord(end_, stream_), "cudaEventRecord");
      check_cuda(cudaEventSynchronize(end_), "cudaEventSynchronize");
      float milliseconds = 0;
      check_cuda(cudaEventElapsedTime(&milliseconds, begin_, end_), "cudaEventElapsedTime");
      if (r >= 0) seconds[static_cast<std::size_t>(r)] = 1e-3 * milliseconds;
    }
    std::sort(seconds.begin(), seconds.end());
    return seconds;
  }

 private:
  cudaStream_t stream_ = nullptr;
  cudaEvent_t begin_ = nullptr, end_ = nullptr;
};

/// Samples in a 3D array, read point by point through a texture without hardware filtering.
template <class T>
struct ArraySource {
  cudaTextureObject_t texture;

  __device__ T at(int i, int j, int k) const {
    return tex3D<T>(texture, static_cast<float>(i) + 0.5f, static_cast<float>(j) + 0.5f,
                    static_cast<float>(k) + 0.5f);
  }
  __device__ PointSampler<T, ArraySource> sampler(const int* whole, int) const {
    return {*this, whole};
  }
};

/// Owns a 3D array and its texture.
class DeviceArray {
 public:
  template <class T>
  DeviceArray(const T* data, const std::array<std::int64_t, 3>& dims) {
    const auto extent =
        make_cudaExtent(static_cast<std::size_t>(dims[0]), static_cast<std::size_t>(dims[1]),
                        static_cast<std::size_t>(dims[2]));
    const cudaChannelFormatDesc format = cudaCreateChannelDesc<T>();
    check_cuda(cudaMalloc3DArray(&array_, &format, extent), "cudaMalloc3DArray");
    cudaMemcpy3DParms copy = {};
    copy.srcPtr = make_cudaPitchedPtr(const_cast<T*>(data), extent.width * sizeof(T), extent.width,
                                      extent.height);
    copy.dstArray = array_;
    copy.extent = extent;
    copy.kind = cudaMemcpyHostToDevice;
    check_cuda(cudaMemcpy3D(&copy), "cudaMemcpy3D");
    check_cuda(cudaDeviceSynchronize(), "cudaDeviceSynchronize");  // as after upload()
    cudaResourceDesc resource = {};
    resource.resType = cudaResourceTypeArray;
    resource.res.array.array = array_;
    cudaTextureDesc reading = {};
    for (cudaTextureAddressMode& mode : reading.addressMode) mode = cudaAddressModeClamp;
    reading.filterMode = cudaFilterModePoint;
    reading.readMode = cudaReadModeElementType;
    check_cuda(cudaCreateTextureObject(&texture_, &resource, &reading, nullptr),
               "cudaCreateTextureObject");
  }
  DeviceArray(const DeviceArray&) = delete;
  DeviceArray& operator=(const DeviceArray&) = delete;
  ~DeviceArray() {
    cudaDestroyTextureObject(texture_);
    cudaFreeArray(array_);
  }
  cudaTextureObject_t texture() const { return texture_; }

 private:
  cudaArray_t array_ = nullptr;
  cudaTextureObject_t texture_ = 0;
};

/// Times layouts and tile shapes; keeps the fastest.
template <class T>
class FloorRun {
 public:
  FloorRun(const AffineJob& job, int device) : job_(job), clock_(device) {
    host_output_.reserve(output_count());
    output_.reserve(output_count());
  }

  template <class Source>
  void take(const std::string& layout, const Source& source) {
    AffineDeviceJob<T, Source> job;
    job.source = source;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      job.source_dims[axis] = static_cast<int>(job_.source_dims[axis]);
      job.output_dims[axis] = static_cast<int>(job_.output_dims[axis]);
      std::copy_n(job_.source_from_output[axis].begin(), 4, job.rows[axis]);
    }
    job.output = output_.view(output_count()).data;
    take<Tile<8, 8>>(layout, job);
    take<Tile<32, 4>>(layout, job);
  }

  const DeviceFloor& best() const { return best_; }

 private:
  template <class Tile, class Source>
  void take(const std::string& layout, const AffineDeviceJob<T, Source>& job) {
    const auto kernel = [&] {
      launch(clock_.stream(),
             job_.filter == Filter::linear ? affine_kernel<Tile, true, T, Source>
                                           : affine_kernel<Tile, false, T, Source>,
             tiles_of<Tile>(job), dim3(floor_threads), 0, job);
    };
    const double seconds = clock_.seconds_of(kernel)[repetitions / 2];
    if (best_.kernel > 0 && seconds >= best_.kernel) return;
    const auto both = clock_.seconds_of([&] {
      kernel();
      check_cuda(cudaMemcpyAsync(host_output_.view(output_count()).data, job.output,
                                 static_cast<std::size_t>(output_count()) * sizeof(T),
                                 cudaMemcpyDeviceToHost, clock_.stream()),
                 "cudaMemcpyAsync to host");
    });
    best_ = {seconds, both[repetitions / 2],
             layout + ", tiles " + std::to_string(Tile::width) + " wide"};
  }

  std::int64_t output_count() const {
    return job_.output_dims[0] * job_.output_dims[1] * job_.output_dims[2];
  }

  const AffineJob& job_;
  Clock clock_;
  PinnedBuffer<T> host_output_;
  DeviceBuffer<T> output_;
  DeviceFloor best_;
};

template <class T>
void upload(const T* host, std::int64_t count, DeviceBuffer<T>& buffer) {
  buffer.reserve(count);
  check_cuda(cudaMemcpy(buffer.view(count).data, host, static_cast<std::size_t>(count) * sizeof(T),
                        cudaMemcpyHostToDevice),
             "cudaMemcpy to device");
  // Of pageable memory it returns when the data are staged; the streams here do not wait for it.
  check_cuda(cudaDeviceSynchronize(), "cudaDeviceSynchronize");
}

template <class T>
DeviceFloor measure(const AffineJob& job, int device) {
  FloorRun<T> run(job, device);
  const auto* const samples = static_cast<const T*>(job.source);
  const auto& dims = job.source_dims;
  DeviceBuffer<T> memory;
  upload(samples, dims[0] * dims[1] * dims[2], memory);
  LinearSource<T> linear{memory.view(0).data, {}};
  BrickedSource<T> bricked{nullptr, {}};
  for (int axis = 0; axis < 3; ++axis) {
    linear.dims[axis] = static_cast<int>(dims[static_cast<std::size_t>(axis)]);
    bricked.bricks[axis] = bricked.bricks_of(linear.dims[axis], axis);
  }
  run.take("linear", linear);
  std::vector<T> arranged(static_cast<std::size_t>(bricked.count()));
  for (int k = 0; k < linear.dims[2]; ++k) {
    for (int j = 0; j < linear.dims[1]; ++j) {
      for (int i = 0; i < linear.dims[0]; ++i) {
        arranged[static_cast<std::size_t>(bricked.place(i, j, k))] =
            samples[(std::int64_t{k} * dims[1] + j) * dims[0] + i];
      }
    }
  }
  upload(arranged.data(), bricked.count(), memory);
  bricked.data = memory.view(0).data;
  run.take("bricked", bricked);
  if constexpr (sizeof(T) < 8) {
    const DeviceArray array(samples, dims);
    run.take("array", ArraySource<T>{array.texture()});
  }
  return run.best();
}
}  // namespace

DeviceFloor measure_device_floor(const AffineJob& job, int device) {
  switch (job.type) {
    case PixelType::uint8:
      return measure<std::uint8_t>(job, device);
    case PixelType::int16:
      return measure<std::int16_t>(job, device);
    case PixelType::float32:
      return measure<float>(job, device);
    default:
      return measure<double>(job, device);
  }
}

double device_copy_bandwidth(int device) {
  constexpr std::int64_t size = std::int64_t{1} << 30;
  const Clock clock(device);
  DeviceBuffer<std::byte> from, to;
  from.reserve(size);
  to.reserve(size);
  const auto seconds = clock.seconds_of([&] {
    check_cuda(cudaMemcpyAsync(to.view(size).data, from.view(size).data, size,
                               cudaMemcpyDeviceToDevice, clock.stream()),
               "cudaMemcpyAsync on device");
  });
  return 2.0 * static_cast<double>(size) / seconds.front();
}

}  // namespace tetwarp::bench
