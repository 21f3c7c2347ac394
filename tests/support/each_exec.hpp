/// @file each_exec.hpp
/// Typed tests over the executors: suites run as X/cpu and, where nvcc compiles, X/cuda.
#pragma once
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "host/warp/cpu/cell_cull_cpu.hpp"
#if defined(__CUDACC__)
#include "kernels/exec/exec_cuda.cuh"
#endif

namespace tetwarp::test {

#if defined(__CUDACC__)
using Execs = ::testing::Types<CpuExec, CudaExec>;
#else
using Execs = ::testing::Types<CpuExec>;
#endif

/// For stages that run on the host only.
using HostExecs = ::testing::Types<CpuExec>;

/// Suite suffixes of TYPED_TEST_SUITE.
struct ExecNames {
  template <class Exec>
  // NOLINTNEXTLINE(readability-identifier-naming): GoogleTest calls it
  static std::string GetName(int) {
    return std::is_same_v<Exec, CpuExec> ? "cpu" : "cuda";
  }
};

/// Sizes around the widths of vectors, warps and blocks.
inline const std::vector<std::int64_t> tricky_sizes = {0, 1, 31, 32, 33, 1025};

/// Arrays in the memory of an executor, kept until the end.
template <class Exec>
class ExecArrays {
 public:
  explicit ExecArrays(Exec& exec) : exec_(exec) {}

  Exec& exec() const { return exec_; }

  template <class T>
  View<T> upload(std::vector<T> values) {
    struct Kept {
      std::vector<T> values;
      typename Exec::template Buffer<T> buffer;
    };
    auto kept = std::make_shared<Kept>();
    kept->values = std::move(values);
    const View<const T> view =
        exec_.resident("test/upload", kept->values.data(),
                       static_cast<std::int64_t>(kept->values.size()), kept->buffer);
    kept_.push_back(kept);
    return {const_cast<T*>(view.data), view.size};  // memory of `kept`, which is not const
  }

  template <class T>
  View<T> zeros(std::int64_t size) {
    return upload(std::vector<T>(static_cast<std::size_t>(size)));
  }

  template <class T>
  std::vector<std::remove_const_t<T>> download(View<T> view) {
    std::vector<std::remove_const_t<T>> values(static_cast<std::size_t>(view.size));
    exec_.get(View<const T>(view), values.data());
    return values;
  }

 private:
  Exec& exec_;
  std::vector<std::shared_ptr<void>> kept_;
};

/// Skips, with the runtime's reason, if no device is usable.
template <class Exec>
class EachExec : public ::testing::Test {
 protected:
  void SetUp() override {
    if constexpr (std::is_same_v<Exec, CpuExec>) {
      exec_.emplace(2);
    } else {
      const BackendStatus status = cuda_status(0);
      if (!status.usable) GTEST_SKIP() << status.reason;
      exec_.emplace(0);
    }
    arrays_.emplace(*exec_);
  }

  Exec& exec() { return *exec_; }
  ExecArrays<Exec>& arrays() { return *arrays_; }

  template <class T>
  View<T> upload(std::vector<T> values) {
    return arrays_->upload(std::move(values));
  }
  template <class T>
  View<T> zeros(std::int64_t size) {
    return arrays_->template zeros<T>(size);
  }
  template <class T>
  auto download(View<T> view) {
    return arrays_->download(view);
  }

 private:
  std::optional<Exec> exec_;
  std::optional<ExecArrays<Exec>> arrays_;
};

}  // namespace tetwarp::test
