/// @file contact_cuda.cu
/// Contact sweeps on a CUDA device: islands that one block can hold in one launch, the others color
/// by color through a recorded graph.
#include <algorithm>

#include "host/contact_device.hpp"
#include "host/warp_backend.hpp"
#include "kernels/contact_sweep.cuh"
#include "kernels/exec_cuda.cuh"

namespace tetwarp {

namespace {

/// Device copies that grow only; freed with the device.
struct StructureBuffers {
  DeviceBuffer<std::int64_t> color_start, dof_start, pair_start, pair_value, block_start,
      block_value, delassus_row;
  DeviceBuffer<std::int32_t> pair_block, block_contact, delassus_column;
  DeviceBuffer<SweepIsland> islands;
  DeviceBuffer<SweepProgress> progress;
  DeviceBuffer<ContactSums> sums;
};

template <class T>
struct SystemBuffers {
  DeviceBuffer<ContactConstants<T>> constants;
  DeviceBuffer<T> free_velocity, offset, jacobian, response, body_free, delassus;
  DeviceBuffer<T> impulse, best, velocity, body_velocity;
};

/// Records what is launched on a stream; the recording ends whatever is thrown meanwhile.
class StreamCapture {
 public:
  explicit StreamCapture(cudaStream_t stream) : stream_(stream) {
    check_cuda(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal),
               "cudaStreamBeginCapture");
  }
  StreamCapture(const StreamCapture&) = delete;
  StreamCapture& operator=(const StreamCapture&) = delete;
  ~StreamCapture() {
    if (is_recording_) cudaStreamEndCapture(stream_, &graph_);
    if (graph_ != nullptr) cudaGraphDestroy(graph_);
  }

  /// What was recorded; stays this object's.
  cudaGraph_t end() {
    is_recording_ = false;
    check_cuda(cudaStreamEndCapture(stream_, &graph_), "cudaStreamEndCapture");
    return graph_;
  }

 private:
  cudaStream_t stream_;
  cudaGraph_t graph_ = nullptr;
  bool is_recording_ = true;
};

/// One sweep of one island, recorded once and launched again and again: a launch per color.
class SweepGraph {
 public:
  template <class Body>
  SweepGraph(cudaStream_t stream,
             const SweepIsland& island,
             const std::int64_t* color_start,
             const Body& body) {
    StreamCapture capture(stream);
    for (std::int64_t k = island.color_begin; k + 1 < island.color_end; ++k) {
      const std::int64_t count = color_start[k + 1] - color_start[k];
      launch(stream, each_kernel<FromContact<Body>>,
             dim3(static_cast<unsigned>((count + each_threads - 1) / each_threads)),
             dim3(each_threads), 0, count, FromContact<Body>{body, color_start[k]});
    }
    check_cuda(cudaGraphInstantiate(&graph_, capture.end(), 0), "cudaGraphInstantiate");
  }
  SweepGraph(const SweepGraph&) = delete;
  SweepGraph& operator=(const SweepGraph&) = delete;
  ~SweepGraph() { cudaGraphExecDestroy(graph_); }

  void launch_on(cudaStream_t stream) const {
    check_cuda(cudaGraphLaunch(graph_, stream), "cudaGraphLaunch");
  }

 private:
  cudaGraphExec_t graph_ = nullptr;
};

class CudaContactDevice final : public ContactDevice {
 public:
  CudaContactDevice(int device, std::string name) : exec_(device), name_(std::move(name)) {}

  std::vector<SweepProgress> sweep(const SweepTask& task,
                                   const ContactStructure& structure,
                                   const ContactSystem<double>& system,
                                   std::vector<double>& impulse) override {
    return run(task, structure, system, impulse, float64_);
  }
  std::vector<SweepProgress> sweep(const SweepTask& task,
                                   const ContactStructure& structure,
                                   const ContactSystem<float>& system,
                                   std::vector<float>& impulse) override {
    return run(task, structure, system, impulse, float32_);
  }
  std::string name() const override { return name_; }

 private:
  template <class T>
  View<const T> upload(const std::vector<T>& host, DeviceBuffer<T>& buffer) {
    if (host.empty()) return {};
    return exec_.resident("contact/upload", host.data(), static_cast<std::int64_t>(host.size()),
                          buffer);
  }
  template <class T>
  View<T> upload_state(const std::vector<T>& host, DeviceBuffer<T>& buffer) {
    upload(host, buffer);
    return buffer.view(static_cast<std::int64_t>(host.size()));
  }

  template <class T>
  std::vector<SweepProgress> run(const SweepTask& task,
                                 const ContactStructure& structure,
                                 const ContactSystem<T>& system,
                                 std::vector<T>& impulse,
                                 SystemBuffers<T>& buffers) {
    exec_.use_stream(nullptr);  // makes the device current on this thread
    const View<const ContactConstants<T>> constants = upload(system.constants, buffers.constants);
    const View<T> r = upload_state(impulse, buffers.impulse);
    SweepJob<T, DelassusSweepBody<T>> local;
    SweepJob<T, BodySweepBody<T>> global;
    std::vector<SweepProgress> progress;
    if (structure.is_local) {
      const DelassusView<T> delassus = {upload(structure.delassus_row, kept_.delassus_row),
                                        upload(structure.delassus_column, kept_.delassus_column),
                                        upload(system.delassus, buffers.delassus),
                                        upload(system.free_velocity, buffers.free_velocity)};
      local.body = {delassus, constants, task.switches, {}, r};
      progress = sweep_all(local, task, structure, system, impulse, buffers);
    } else {
      const View<const std::int64_t> dof_start = upload(structure.dof_start, kept_.dof_start);
      const BodiesView<T> bodies = {{upload(structure.pair_start, kept_.pair_start),
                                     upload(structure.pair_block, kept_.pair_block),
                                     upload(structure.pair_value, kept_.pair_value), dof_start},
                                    upload(system.jacobian, buffers.jacobian),
                                    upload(system.response, buffers.response),
                                    upload(system.offset, buffers.offset)};
      const View<T> v = upload_state(system.body_free, buffers.body_velocity);
      const BlockContacts contacts = {upload(structure.block_start, kept_.block_start),
                                      upload(structure.block_contact, kept_.block_contact),
                                      upload(structure.block_value, kept_.block_value)};
      body_relax(exec_, 0, dof_start.size - 1,
                 BodyVelocityBody<T>{contacts, dof_start, bodies.response, r,
                                     upload(system.body_free, buffers.body_free), v});
      global.body = {bodies, constants, task.switches, {}, r, v};
      progress = sweep_all(global, task, structure, system, impulse, buffers);
    }
    exec_.times();  // hands the events of this solve back
    return progress;
  }

  /// @param job  its body is set
  template <class T, class Body>
  std::vector<SweepProgress> sweep_all(SweepJob<T, Body>& job,
                                       const SweepTask& task,
                                       const ContactStructure& structure,
                                       const ContactSystem<T>& system,
                                       std::vector<T>& impulse,
                                       SystemBuffers<T>& buffers) {
    const auto island_count = static_cast<std::int64_t>(task.islands.size());
    const auto first_small = std::find_if(
        task.islands.begin(), task.islands.end(),
        [](const SweepIsland& island) { return island.contact_count() <= sweep_contacts; });
    const std::int64_t large_count = first_small - task.islands.begin();
    const std::int64_t small_count = island_count - large_count;
    job.free_velocity = upload(system.free_velocity, buffers.free_velocity);
    job.best = upload_state(impulse, buffers.best);
    buffers.velocity.reserve(job.best.size);
    job.velocity = buffers.velocity.view(job.best.size);
    job.limit = task.limit;
    std::vector<SweepProgress> progress(task.islands.size());
    if (small_count > 0) {
      job.color_start = upload(structure.color_start, kept_.color_start);
      job.islands = {upload(task.islands, kept_.islands).data + large_count, small_count};
      job.shared_values = shared_values_for<T>({task.islands.data() + large_count, small_count});
      kept_.progress.reserve(small_count);
      job.progress = kept_.progress.view(small_count);
      contact_sweep_islands(exec_.stream(), job);
    }
    for (std::int64_t i = 0; i < large_count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      progress[k] = sweep_large(job, task.islands[k], structure.color_start.data());
    }
    if (small_count > 0) {
      exec_.read(View<const SweepProgress>(job.progress), progress.data() + large_count);
    }
    exec_.read(View<const T>(job.best), impulse.data());
    return progress;
  }

  /// An island on the whole device; the host looks at the residual every few sweeps.
  template <class T, class Body>
  SweepProgress sweep_large(const SweepJob<T, Body>& job,
                            const SweepIsland& island,
                            const std::int64_t* color_start) {
    const cudaStream_t stream = exec_.stream();
    const SweepGraph one_sweep(stream, island, color_start, job.body);
    const auto term = term_of(job.body, job.free_velocity, job.velocity);
    const std::int64_t needed = sums_needed(island.contact_count());
    kept_.sums.reserve(needed);
    const View<ContactSums> sums = kept_.sums.view(needed);
    const std::int64_t first = 3 * island.slot_begin;
    const std::size_t bytes = static_cast<std::size_t>(3 * island.contact_count()) * sizeof(T);
    SweepProgress progress;
    for (std::int64_t swept = 0;;) {
      contact_sums(stream, island.slot_begin, island.slot_end, term, sums);
      ContactSums measured;
      exec_.read(View<const ContactSums>{sums.data + needed - 1, 1}, &measured);
      if (progress.take(measured, swept, job.limit, island.allowed)) {
        check_cuda(cudaMemcpyAsync(job.best.data + first, job.body.impulse.data + first, bytes,
                                   cudaMemcpyDeviceToDevice, stream),
                   "cudaMemcpyAsync on device");
      }
      if (progress.is_done) return progress;
      const std::int64_t next = std::min(swept + sweeps_per_look, job.limit.max_sweeps);
      for (; swept < next; ++swept) one_sweep.launch_on(stream);
    }
  }

  CudaExec exec_;
  std::string name_;
  StructureBuffers kept_;
  SystemBuffers<double> float64_;
  SystemBuffers<float> float32_;
};

}  // namespace

std::unique_ptr<ContactDevice> make_contact_device(int device) {
  const BackendStatus status = cuda_status(device);
  if (!status.usable)
    throw CudaError("cuda device " + std::to_string(device) + ": " + status.reason);
  return std::make_unique<CudaContactDevice>(device, status.device);
}

}  // namespace tetwarp
