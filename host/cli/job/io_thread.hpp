/// @file io_thread.hpp
/// One thread that runs tasks on files in the order of their calls. HDF5 may be built without
/// support for threads: two threads must not call it at the same time.
#pragma once
#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

namespace tetwarp::cli {

/// The destructor waits for the running task and discards those that have not begun.
class IoThread {
 public:
  IoThread() : thread_([this] { work(); }) {}
  IoThread(const IoThread&) = delete;
  IoThread& operator=(const IoThread&) = delete;
  ~IoThread() {
    {
      const std::lock_guard guard(lock_);
      is_ending_ = true;
      tasks_.clear();
    }
    changed_.notify_one();
    thread_.join();
  }

  /// Queues a task. The future has its result or throws its exception.
  template <class Task>
  auto run(Task&& task) {
    using Result = std::invoke_result_t<Task>;
    auto shared = std::make_shared<std::packaged_task<Result()>>(std::forward<Task>(task));
    std::future<Result> result = shared->get_future();
    {
      const std::lock_guard guard(lock_);
      tasks_.emplace_back([shared] { (*shared)(); });
    }
    changed_.notify_one();
    return result;
  }

 private:
  void work() {
    for (;;) {
      std::function<void()> task;
      {
        std::unique_lock guard(lock_);
        changed_.wait(guard, [this] { return is_ending_ || !tasks_.empty(); });
        if (is_ending_) return;
        task = std::move(tasks_.front());
        tasks_.pop_front();
      }
      task();
    }
  }

  std::mutex lock_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;
  bool is_ending_ = false;
  std::thread thread_;  ///< last member: it uses the others
};

}  // namespace tetwarp::cli
