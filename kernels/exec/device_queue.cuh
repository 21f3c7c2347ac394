/// @file device_queue.cuh
/// The streams of an executor: kernels on one, uploads and downloads on two others, so that copies
/// of one step overlap with kernels of another; the events between them, stage clocks and launches.
#pragma once
#include <memory>
#include <string>
#include <utility>

#include "kernels/base/stage_times.hpp"
#include "kernels/exec/exec_stream.cuh"
#include "kernels/exec/launch_list.cuh"

namespace tetwarp {

/// All work is enqueued and returns before it has run, unless stated. Two steps may be in flight:
/// each has its own events and times; enter() chooses the current one. Without clocks the launches
/// between begin_compute() and end_compute() are made at the end, as one CUDA graph.
class DeviceQueue {
 public:
  /// @param clocks  off: times() are empty
  /// @pre the device is current
  DeviceQueue(int device, StageClocks clocks)
      : state_(std::make_shared<State>(device)), clocks_(clocks) {}
  /// The same streams and steps as another queue.
  DeviceQueue(const DeviceQueue& other, StageClocks clocks)
      : state_(other.state_), clocks_(clocks) {}

  int number() const { return state_->device; }
  std::string device() const {
    cudaDeviceProp properties;
    check_cuda(cudaGetDeviceProperties(&properties, state_->device), "cudaGetDeviceProperties");
    return properties.name;
  }
  int threads() const { return 1; }

  /// The stream of kernels, on which all launches so far have been made.
  cudaStream_t stream() const {
    make_launches();
    return state_->stream;
  }

  /// Makes `flight`, 0 or 1, the current step: all calls after it belong to that step. Initially 0.
  /// @returns  an object during whose life the device is the current one of this thread
  DeviceScope enter(int flight = 0) {
    state_->flight = &state_->flights[flight];
    return DeviceScope(state_->device);
  }

  /// Later kernels run on the caller's stream; null: on this executor's own. Waits for the kernels
  /// of the previous stream if it changes.
  void use_stream(void* stream) {
    const cudaStream_t next =
        stream != nullptr ? static_cast<cudaStream_t>(stream) : cudaStream_t{state_->own_stream};
    if (next == state_->stream) return;
    check_cuda(cudaStreamSynchronize(state_->stream), "cudaStreamSynchronize");
    state_->stream = next;
  }

  /// Later kernels run on the caller's stream; without one they wait for the default stream.
  void follow(void* stream) {
    use_stream(stream);
    if (stream == nullptr && cudaStreamQuery(cudaStreamLegacy) != cudaSuccess) {
      cudaGetLastError();  // not ready is no error
      flight().given.record(cudaStreamLegacy);
      flight().given.make_wait(state_->stream);
    }
  }

  /// To be called before the first kernel of the current step: its kernels wait for its upload().
  /// @param has_device_memory  whether the step uses device memory of the caller
  void begin_compute(void* stream, bool has_device_memory) {
    state_->launches.clear();  // of a step that failed
    use_stream(stream);
    if (flight().has_upload) flight().uploaded.make_wait(state_->stream);
    if (has_device_memory) follow(stream);
    state_->is_collecting = clocks_ == StageClocks::off;
  }
  /// To be called after the last kernel of the current step.
  /// @param has_download  whether downloads will follow
  void end_compute(bool has_download) {
    state_->is_collecting = false;
    state_->graphs.launch(state_->stream, state_->launches);
    flight().is_recorded = has_download || state_->stream != state_->own_stream;
    flight().is_awaited = false;
    if (flight().is_recorded) flight().computed.record(state_->stream);
  }
  /// Waits for the kernels of the current step. Afterwards the caller may destroy its stream.
  /// @pre without an event of its own the step is the last on this executor's stream
  void wait_computed() {
    if (flight().is_recorded) {
      flight().computed.wait();
    } else {
      check_cuda(cudaStreamSynchronize(state_->own_stream), "cudaStreamSynchronize");
    }
    state_->stream = state_->own_stream;
  }

  /// To be called after the last download of the current step.
  void end_download() {
    flight().delivered.record(state_->download);
    flight().has_delivery = true;
  }
  /// Waits for the downloads of the current step.
  void wait_delivered() {
    if (std::exchange(flight().has_delivery, false)) flight().delivered.wait();
  }

  /// Waits for the kernels on stream().
  void wait() const { check_cuda(cudaStreamSynchronize(stream()), "cudaStreamSynchronize"); }
  /// Waits for all enqueued work and ignores its errors.
  void drain() noexcept {
    state_->launches.clear();
    state_->is_collecting = false;
    for (cudaStream_t stream :
         {cudaStream_t{state_->upload}, state_->stream, cudaStream_t{state_->download}}) {
      cudaStreamSynchronize(stream);
    }
    state_->stream = state_->own_stream;
  }

  /// Seconds per label of the current step since the last clear() of the result; waits for its
  /// work.
  StageTimes& times() { return flight().times(); }

  /// Launches a kernel on stream(), or at the end of the step.
  template <class... Parameters, class... Args>
  void enqueue(const char* label,
               void (*kernel)(Parameters...),
               dim3 grid,
               dim3 block,
               std::size_t shared_bytes,
               const Args&... args) {
    if (state_->is_collecting) {
      state_->launches.push_back(std::make_unique<PendingKernel<Parameters...>>(
          kernel, grid, block, shared_bytes, args...));
      return;
    }
    timed(label, [&] { launch(state_->stream, kernel, grid, block, shared_bytes, args...); });
  }

  /// Calls work(), which enqueues on stream(), and adds its time on the device to that of `label`.
  template <class Work>
  void timed(const char* label, Work&& work) {
    timed(label, stream(), std::forward<Work>(work));
  }

 protected:
  DeviceFlight& flight() { return *state_->flight; }
  cudaStream_t upload_stream() const { return state_->upload; }
  cudaStream_t download_stream() const { return state_->download; }
  template <class Work>
  void timed(const char* label, cudaStream_t on, Work&& work) {
    if (clocks_ == StageClocks::off) return work();
    flight().timed(label, on, std::forward<Work>(work));
  }

 private:
  struct State {
    int device;
    DeviceStream own_stream, upload, download;
    DeviceFlight flights[2];
    cudaStream_t stream = own_stream;
    DeviceFlight* flight = flights;
    bool is_collecting = false;
    LaunchList launches;  ///< collected and not made yet
    LaunchGraphs graphs;

    explicit State(int number) : device(number) {}
    State(const State&) = delete;
    State& operator=(const State&) = delete;
  };

  /// Makes the collected launches one by one, before work that is none.
  void make_launches() const {
    const LaunchList launches = std::exchange(state_->launches, {});
    for (const auto& one : launches) one->launch_on(state_->stream);
  }

  std::shared_ptr<State> state_;
  StageClocks clocks_;
};

}  // namespace tetwarp
