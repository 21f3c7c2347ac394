/// @file launch_list.cuh
/// The launches of a step, collected and then made at once: as a CUDA graph that is kept for the
/// next step with the same kernels.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "kernels/exec/exec_buffer.cuh"
#include "kernels/exec/launch.hpp"

namespace tetwarp {

/// A kernel with its arguments.
class PendingLaunch {
 public:
  virtual ~PendingLaunch() = default;
  virtual void launch_on(cudaStream_t stream) const = 0;
  /// @returns parameters that refer to this object
  virtual cudaKernelNodeParams node() = 0;
  virtual const void* kernel() const = 0;
  /// Whether the other launch has the same kernel, blocks and bytes of arguments.
  virtual bool is(const PendingLaunch& other) const = 0;
};

template <class... Parameters>
class PendingKernel : public PendingLaunch {
 public:
  PendingKernel(void (*kernel)(Parameters...),
                dim3 grid,
                dim3 block,
                std::size_t shared_bytes,
                const std::remove_const_t<Parameters>&... values)
      : kernel_(kernel),
        grid_(grid),
        block_(block),
        shared_bytes_(shared_bytes),
        values_(values...) {
    std::apply([&](auto&... value) { addresses_ = {&value...}; }, values_);
  }
  PendingKernel(const PendingKernel&) = delete;
  PendingKernel& operator=(const PendingKernel&) = delete;

  void launch_on(cudaStream_t stream) const override {
    std::apply(
        [&](const auto&... value) {
          launch(stream, kernel_, grid_, block_, shared_bytes_, value...);
        },
        values_);
  }
  cudaKernelNodeParams node() override {
    return node_params(kernel_, grid_, block_, shared_bytes_, values_, addresses_.data());
  }
  const void* kernel() const override { return reinterpret_cast<const void*>(kernel_); }
  bool is(const PendingLaunch& launch) const override {
    if (launch.kernel() != kernel()) return false;
    const auto& other = static_cast<const PendingKernel&>(launch);
    const auto same = [](const dim3& a, const dim3& b) {
      return a.x == b.x && a.y == b.y && a.z == b.z;
    };
    return same(grid_, other.grid_) && same(block_, other.block_) &&
           shared_bytes_ == other.shared_bytes_ &&
           has_bytes_of(other, std::index_sequence_for<Parameters...>{});
  }

 private:
  template <std::size_t... index>
  bool has_bytes_of(const PendingKernel& other, std::index_sequence<index...>) const {
    return (... && (std::memcmp(addresses_[index], other.addresses_[index],
                                // NOLINTNEXTLINE(bugprone-sizeof-expression): pointers, too
                                sizeof(std::get<index>(values_))) == 0));
  }

  void (*kernel_)(Parameters...);
  dim3 grid_, block_;
  std::size_t shared_bytes_;
  std::tuple<std::remove_const_t<Parameters>...> values_;
  std::array<void*, sizeof...(Parameters)> addresses_;
};

using LaunchList = std::vector<std::unique_ptr<PendingLaunch>>;

/// A graph of launches, one after the other.
class LaunchGraph {
 public:
  explicit LaunchGraph(LaunchList launches) : launches_(std::move(launches)) {
    try {
      check_cuda(cudaGraphCreate(&graph_, 0), "cudaGraphCreate");
      for (const auto& launch : launches_) {
        const cudaKernelNodeParams parameters = launch->node();
        const bool is_first = nodes_.empty();
        const cudaGraphNode_t before = is_first ? cudaGraphNode_t{} : nodes_.back();
        nodes_.emplace_back();
        check_cuda(cudaGraphAddKernelNode(&nodes_.back(), graph_, is_first ? nullptr : &before,
                                          is_first ? 0 : 1, &parameters),
                   "cudaGraphAddKernelNode");
      }
      check_cuda(cudaGraphInstantiate(&exec_, graph_, 0), "cudaGraphInstantiate");
    } catch (...) {
      release();
      throw;
    }
  }
  LaunchGraph(const LaunchGraph&) = delete;
  LaunchGraph& operator=(const LaunchGraph&) = delete;
  ~LaunchGraph() { release(); }

  bool is(const LaunchList& launches) const {
    return has_kernels_of(launches) &&
           std::equal(launches_.begin(), launches_.end(), launches.begin(),
                      [](const auto& a, const auto& b) { return a->is(*b); });
  }
  bool has_kernels_of(const LaunchList& launches) const {
    return std::equal(launches_.begin(), launches_.end(), launches.begin(), launches.end(),
                      [](const auto& a, const auto& b) { return a->kernel() == b->kernel(); });
  }
  /// Replaces the arguments of later launches. @pre has_kernels_of(launches)
  void take(LaunchList launches) {
    for (std::size_t i = 0; i < launches.size(); ++i) {
      if (launches_[i]->is(*launches[i])) continue;
      const cudaKernelNodeParams parameters = launches[i]->node();
      check_cuda(cudaGraphExecKernelNodeSetParams(exec_, nodes_[i], &parameters),
                 "cudaGraphExecKernelNodeSetParams");
      launches_[i] = std::move(launches[i]);
    }
  }
  void launch_on(cudaStream_t stream) {
    check_cuda(cudaGraphLaunch(exec_, stream), "cudaGraphLaunch");
  }

 private:
  void release() noexcept {
    if (exec_ != nullptr) cudaGraphExecDestroy(exec_);
    if (graph_ != nullptr) cudaGraphDestroy(graph_);
  }

  LaunchList launches_;
  cudaGraph_t graph_ = nullptr;
  cudaGraphExec_t exec_ = nullptr;
  std::vector<cudaGraphNode_t> nodes_;
};

/// The graphs of the last steps. Steps alternate between two buffers, and two may be in flight:
/// with four graphs a series repeats its launches.
class LaunchGraphs {
 public:
  static constexpr std::size_t most = 4;
  static constexpr std::size_t fewest_launches = 3;  ///< fewer are launched one by one

  /// Makes the launches in order on a stream; afterwards the list is empty.
  void launch(cudaStream_t stream, LaunchList& launches) {
    LaunchList now = std::exchange(launches, {});
    if (now.size() < fewest_launches) {
      for (const auto& one : now) one->launch_on(stream);
      return;
    }
    LaunchGraph& graph = graph_of(std::move(now));
    graph.launch_on(stream);
  }

 private:
  /// Graphs are ordered by their last use, the latest at the end.
  LaunchGraph& graph_of(LaunchList launches) {
    auto found = std::find_if(graphs_.begin(), graphs_.end(),
                              [&](const auto& graph) { return graph->is(launches); });
    if (found != graphs_.end()) {
      std::rotate(found, found + 1, graphs_.end());
      return *graphs_.back();
    }
    std::unique_ptr<LaunchGraph> graph;
    if (graphs_.size() == most) {
      graph = std::move(graphs_.front());
      graphs_.erase(graphs_.begin());
    }
    if (graph != nullptr && graph->has_kernels_of(launches)) {
      graph->take(std::move(launches));
    } else {
      graph = std::make_unique<LaunchGraph>(std::move(launches));
    }
    graphs_.push_back(std::move(graph));
    return *graphs_.back();
  }

  std::vector<std::unique_ptr<LaunchGraph>> graphs_;
};

}  // namespace tetwarp
