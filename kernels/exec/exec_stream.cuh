/// @file exec_stream.cuh
/// Streams and events of a device, for dependencies between streams and for timing.
#pragma once
#include <cstddef>
#include <utility>
#include <vector>

#include "kernels/base/slice_bytes.hpp"
#include "kernels/base/stage_times.hpp"
#include "kernels/exec/exec_buffer.cuh"

namespace tetwarp {

/// Makes a device current on this thread during its life, then the one that was before.
class DeviceScope {
 public:
  explicit DeviceScope(int device) {
    check_cuda(cudaGetDevice(&before_), "cudaGetDevice");
    if (device == before_) return;
    check_cuda(cudaSetDevice(device), "cudaSetDevice");
    is_changed_ = true;
  }
  DeviceScope(const DeviceScope&) = delete;
  DeviceScope& operator=(const DeviceScope&) = delete;
  ~DeviceScope() {
    if (is_changed_) cudaSetDevice(before_);
  }

 private:
  int before_ = 0;
  bool is_changed_ = false;
};

/// A stream of the current device, independent of the default one.
class DeviceStream {
 public:
  DeviceStream() {
    check_cuda(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking),
               "cudaStreamCreateWithFlags");
  }
  DeviceStream(const DeviceStream&) = delete;
  DeviceStream& operator=(const DeviceStream&) = delete;
  ~DeviceStream() { cudaStreamDestroy(stream_); }

  operator cudaStream_t() const { return stream_; }

 private:
  cudaStream_t stream_ = nullptr;
};

/// A point in a stream that other streams and the host can wait for.
class DeviceEvent {
 public:
  enum class Clock { off, on };

  explicit DeviceEvent(Clock clock = Clock::off) {
    check_cuda(cudaEventCreateWithFlags(&event_, clock == Clock::on ? 0 : cudaEventDisableTiming),
               "cudaEventCreateWithFlags");
  }
  DeviceEvent(DeviceEvent&& other) noexcept : event_(std::exchange(other.event_, nullptr)) {}
  DeviceEvent& operator=(DeviceEvent&&) = delete;
  ~DeviceEvent() {
    if (event_ != nullptr) cudaEventDestroy(event_);
  }

  void record(cudaStream_t stream) const {
    check_cuda(cudaEventRecord(event_, stream), "cudaEventRecord");
  }
  /// Work enqueued on `stream` from now on waits for the event; not if it was never recorded.
  void make_wait(cudaStream_t stream) const {
    check_cuda(cudaStreamWaitEvent(stream, event_, 0), "cudaStreamWaitEvent");
  }
  void wait() const { check_cuda(cudaEventSynchronize(event_), "cudaEventSynchronize"); }
  /// Whether wait() would return at once.
  bool is_done() const {
    const cudaError_t status = cudaEventQuery(event_);
    if (status == cudaErrorNotReady) {
      cudaGetLastError();  // not ready is no error
      return false;
    }
    check_cuda(status, "cudaEventQuery");
    return true;
  }

  /// Time between two events [s]. @pre both have completed
  double seconds_since(const DeviceEvent& begin) const {
    float milliseconds = 0;
    check_cuda(cudaEventElapsedTime(&milliseconds, begin.event_, event_), "cudaEventElapsedTime");
    return milliseconds * 1e-3;
  }

 private:
  cudaEvent_t event_ = nullptr;
};

/// Copies parts of slices from the device to the host in one operation.
/// @param to_pitch  rows from one slice to the next at `to`
inline void copy_slices(const std::byte* from,
                        std::byte* to,
                        const SliceBytes& part,
                        std::size_t to_pitch,
                        cudaStream_t stream) {
  if (part.slices == 1 || (part.rows == part.pitch && part.pitch == to_pitch)) {
    check_cuda(cudaMemcpyAsync(to, from, part.row * part.rows * part.slices, cudaMemcpyDeviceToHost,
                               stream),
               "cudaMemcpyAsync to host");
    return;
  }
  cudaMemcpy3DParms copy = {};
  copy.srcPtr = make_cudaPitchedPtr(const_cast<std::byte*>(from), part.row, part.row, part.pitch);
  copy.dstPtr = make_cudaPitchedPtr(to, part.row, part.row, to_pitch);
  copy.extent = make_cudaExtent(part.row, part.rows, part.slices);
  copy.kind = cudaMemcpyDeviceToHost;
  check_cuda(cudaMemcpy3DAsync(&copy, stream), "cudaMemcpy3DAsync to host");
}

/// Events and stage times of one step in flight.
class DeviceFlight {
 public:
  DeviceEvent given;          ///< the default stream's work before the step
  DeviceEvent uploaded;       ///< the step's input is on the device
  DeviceEvent computed;       ///< the step's kernels have run
  DeviceEvent delivered;      ///< the step's results are in memory of the host
  bool has_upload = false;    ///< `uploaded` was recorded for the step
  bool is_recorded = false;   ///< `computed` was
  bool is_awaited = false;    ///< the stream of downloads waits for `computed`
  bool has_delivery = false;  ///< `delivered` was recorded

  /// Calls work(), which enqueues on `stream`, and adds its time on the device to that of `label`.
  template <class Work>
  void timed(const char* label, cudaStream_t stream, Work&& work) {
    if (used_ == spans_.size()) spans_.emplace_back();
    Span& span = spans_[used_];
    span.label = label;
    span.begin.record(stream);
    work();
    span.end.record(stream);
    ++used_;  // after work(): if it throws, the span has no end
  }

  /// Seconds per label since the last clear() of the result; waits until all timed work is done.
  StageTimes& times() {
    for (std::size_t i = 0; i < used_; ++i) {
      const Span& span = spans_[i];
      span.end.wait();
      times_.add(span.label, span.end.seconds_since(span.begin));
    }
    used_ = 0;
    return times_;
  }

 private:
  struct Span {
    const char* label = nullptr;
    DeviceEvent begin{DeviceEvent::Clock::on};
    DeviceEvent end{DeviceEvent::Clock::on};
  };

  std::vector<Span> spans_;
  std::size_t used_ = 0;
  StageTimes times_;
};

}  // namespace tetwarp
