/// @file gpu_pointers.cpp
/// Warps a volume that is in device memory, by node positions in device memory, into device memory,
/// on a stream of the caller: nothing but counters is copied to the host. Without a usable CUDA
/// device it prints the reason and ends.
#include <cuda_runtime.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <iterator>
#include <stdexcept>
#include <tetwarp/tetwarp.hpp>

namespace {
void check(cudaError_t status) {
  if (status != cudaSuccess) throw std::runtime_error(cudaGetErrorString(status));
}

/// Device memory that begins as a copy of host memory.
class DeviceCopy {
 public:
  DeviceCopy(const void* host, std::size_t bytes) {
    check(cudaMalloc(&data_, bytes));
    check(cudaMemcpy(data_, host, bytes, cudaMemcpyHostToDevice));
  }
  DeviceCopy(const DeviceCopy&) = delete;
  DeviceCopy& operator=(const DeviceCopy&) = delete;
  ~DeviceCopy() { cudaFree(data_); }
  void* data() const { return data_; }

 private:
  void* data_ = nullptr;
};
}  // namespace

int main() {
  using tetwarp::Memory;
  const tetwarp::BackendStatus cuda = tetwarp::available_backends().front();
  if (!cuda.usable) {
    std::printf("nothing done: no usable CUDA device (%s)\n", cuda.reason.c_str());
    return 0;
  }
  const tetwarp::Volume phantom = tetwarp::make_phantom({128, 80, 61});
  const tetwarp::Mesh mesh = tetwarp::make_lattice_mesh(phantom);
  const auto twisted = tetwarp::deform_positions(mesh, {}, 1.0);
  const DeviceCopy source(phantom.data.data(), phantom.data.size());
  const DeviceCopy positions(twisted.data(), twisted.size() * sizeof twisted.front());
  const DeviceCopy output(phantom.data.data(), phantom.data.size());
  cudaStream_t stream = nullptr;
  check(cudaStreamCreate(&stream));

  const tetwarp::VolumeView view(phantom.grid, phantom.type, 1, source.data(), Memory::device);
  tetwarp::Warper warper({&view, 1}, mesh, {.backend = tetwarp::Backend::cuda});
  void* const samples = output.data();
  const tetwarp::StepReport report = warper.step(
      {static_cast<const double*>(positions.data()), std::ssize(twisted), Memory::device},
      {.volumes = {&samples, 1}, .memory = Memory::device, .stream = stream});
  // Work that the caller queues on `stream` from here on reads the warped volume.
  std::printf("%s: %lld voxels covered, %.3f ms\n", cuda.device.c_str(),
              static_cast<long long>(report.counts.covered), 1e3 * report.timings.total);

  // The same voxels are covered on every back end.
  const auto expected = tetwarp::warp(phantom, mesh, twisted, {.backend = tetwarp::Backend::cpu});
  tetwarp::Volume copied = phantom;
  check(cudaMemcpyAsync(copied.data.data(), samples, copied.data.size(), cudaMemcpyDeviceToHost,
                        stream));
  check(cudaStreamSynchronize(stream));
  check(cudaStreamDestroy(stream));
  double max_difference = 0;
  for (std::size_t v = 0; v < copied.samples<float>().size(); ++v) {
    const double difference = copied.samples<float>()[v] - expected.volume.samples<float>()[v];
    max_difference = std::max(max_difference, std::abs(difference));
  }
  std::printf("largest difference from back end cpu: %.1e\n", max_difference);
  return report.counts.covered == expected.report.counts.covered && max_difference < 1e-5 ? 0 : 1;
}
