/// @file parallel.cpp
/// The pool of threads, and loops that it shares out.
#include "host/base/parallel.hpp"

#include <pthread.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace tetwarp {
namespace {
/// True on a thread that executes a task.
thread_local bool is_in_task = false;

/// The tasks of one call; lives on the stack of the calling thread.
struct Loop {
  std::int64_t count;
  const void* context;
  void (*call)(const void*, std::int64_t);
  int free_places;                     ///< threads of the pool that may still join
  std::atomic<std::int64_t> next = 0;  ///< first task that no thread has taken
  std::atomic<int> helpers = 0;        ///< threads of the pool that execute tasks
  std::mutex error_mutex = {};
  std::exception_ptr error = {};  ///< what a task has thrown
  std::int64_t thrown_by = 0;     ///< that task

  void run_tasks() {
    is_in_task = true;
    for (std::int64_t i = next++; i < count; i = next++) {
      try {
        call(context, i);
      } catch (...) {
        end_with(std::current_exception(), i);
      }
    }
    is_in_task = false;
  }
  /// All tasks before this one have begun, so that the one that is kept is the same in every run.
  void end_with(std::exception_ptr thrown, std::int64_t task) {
    const std::lock_guard lock(error_mutex);
    if (error && thrown_by < task) return;
    error = std::move(thrown);
    thrown_by = task;
    next = count;
  }
};

/// Waits until the condition holds, for 20 microseconds at most: between the loops of one step,
/// less than it takes to wake a thread. Other threads of the processor go first.
template <class Condition>
bool wait_briefly(const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::microseconds(20);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::yield();
  }
  return true;
}

class ThreadPool {
 public:
  /// Executes the tasks of a loop on the calling thread and on free_places others.
  void run(Loop& loop) {
    const int helpers = loop.free_places;
    int sleepers = 0;
    {
      const std::lock_guard lock(mutex_);
      start_threads(helpers);
      loops_.push_back(&loop);
      ++published_;
      sleepers = std::min(helpers, sleeping_);
    }
    for (int k = 0; k < sleepers; ++k) wake_.notify_one();
    loop.run_tasks();
    {
      const std::lock_guard lock(mutex_);
      loops_.erase(std::find(loops_.begin(), loops_.end(), &loop));
    }
    const auto is_done = [&] { return loop.helpers == 0; };
    wait_briefly(is_done);
    // Helpers change the number while they hold the mutex and do not touch the loop afterwards.
    std::unique_lock lock(mutex_);
    finished_.wait(lock, is_done);
  }

 private:
  /// @pre the mutex is held
  void start_threads(int wanted) {
    try {
      for (; threads_ < wanted; ++threads_) std::thread([this] { serve(); }).detach();
    } catch (const std::system_error&) {
      // The system allows no more: the calling threads do more of the work.
    }
  }

  void serve() {
    std::unique_lock lock(mutex_);
    for (;;) {
      const auto open = std::find_if(loops_.begin(), loops_.end(),
                                     [](const Loop* loop) { return loop->free_places > 0; });
      if (open == loops_.end()) {
        wait_for_a_loop(lock);
        continue;
      }
      Loop& loop = **open;
      --loop.free_places;
      ++loop.helpers;
      lock.unlock();
      loop.run_tasks();
      lock.lock();
      if (--loop.helpers == 0) finished_.notify_all();
    }
  }

  void wait_for_a_loop(std::unique_lock<std::mutex>& lock) {
    const std::uint64_t seen = published_;
    const auto is_new = [&] { return published_ != seen; };
    lock.unlock();
    const bool found = wait_briefly(is_new);
    lock.lock();
    if (found) return;
    ++sleeping_;
    wake_.wait(lock, is_new);
    --sleeping_;
  }

  std::mutex mutex_;
  std::condition_variable wake_;      ///< a loop was published
  std::condition_variable finished_;  ///< a loop has no helpers left
  std::vector<Loop*> loops_;          ///< with tasks that may be left
  std::atomic<std::uint64_t> published_ = 0;
  int threads_ = 0;   ///< of the pool
  int sleeping_ = 0;  ///< of these
};

/// Never destroyed: its threads use it until the process ends. The child of a fork, which has none
/// of them, and may have its mutex locked for ever, gets a new one.
ThreadPool*& current_pool() {
  static ThreadPool* pool = [] {
    if (pthread_atfork(nullptr, nullptr, [] { current_pool() = new ThreadPool; }) != 0) {
      throw std::bad_alloc();
    }
    return new ThreadPool;
  }();
  return pool;
}

ThreadPool& thread_pool() {
  return *current_pool();
}
}  // namespace

int thread_count(int requested) {
  if (requested < 0 || requested > max_threads) {
    throw std::invalid_argument("threads: " + std::to_string(requested) +
                                ", expected 0 (all cores) to " + std::to_string(max_threads));
  }
  if (requested > 0) return requested;
  return std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, max_threads);
}

void run_parallel_tasks(int threads,
                        std::int64_t count,
                        const void* context,
                        void (*call)(const void*, std::int64_t)) {
  if (is_in_task) {
    for (std::int64_t i = 0; i < count; ++i) call(context, i);
    return;
  }
  const auto helpers = std::min<std::int64_t>({threads, count, max_threads}) - 1;
  Loop loop{count, context, call, static_cast<int>(helpers)};
  thread_pool().run(loop);
  if (loop.error) std::rethrow_exception(loop.error);
}

}  // namespace tetwarp
