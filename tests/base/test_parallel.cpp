#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <ctime>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "host/base/parallel.hpp"

namespace tetwarp::test {
namespace {
TEST(Parallel, EveryTaskRunsOnce) {
  for (const int threads : {1, 2, 3, 8}) {
    for (const std::int64_t count : {0, 1, 2, 7, 1000}) {
      std::vector<std::atomic<int>> calls(static_cast<std::size_t>(count));

      parallel_tasks(threads, count, [&](std::int64_t i) { ++calls[static_cast<std::size_t>(i)]; });
      parallel_for(threads, count, [&](std::int64_t i) { ++calls[static_cast<std::size_t>(i)]; });

      for (const std::atomic<int>& call : calls) EXPECT_EQ(call, 2) << threads << " " << count;
    }
  }
}

TEST(Parallel, UsesNoMoreThreadsThanRequested) {
  std::mutex mutex;
  std::set<std::thread::id> used;
  for (int repetition = 0; repetition < 50; ++repetition) {
    parallel_tasks(3, 100, [&](std::int64_t) {
      const std::lock_guard lock(mutex);
      used.insert(std::this_thread::get_id());
    });
    EXPECT_LE(used.size(), 3u);
    used.clear();
  }
}

/// Two tasks that wait for each other end only if they run at the same time.
TEST(Parallel, TasksRunAtTheSameTime) {
  std::atomic<int> arrived = 0;
  parallel_tasks(2, 2, [&](std::int64_t) {
    ++arrived;
    while (arrived < 2) std::this_thread::yield();
  });
  EXPECT_EQ(arrived, 2);
}

TEST(Parallel, ThrowsWhatTheFirstOfTheFailingTasksThrows) {
  for (const int threads : {1, 2, 8}) {
    for (int repetition = 0; repetition < 100; ++repetition) {
      std::vector<std::atomic<int>> calls(100);
      try {
        parallel_tasks(threads, 100, [&](std::int64_t i) {
          ++calls[static_cast<std::size_t>(i)];
          parallel_tasks(threads, 2, [&](std::int64_t) {
            if (i % 40 == 39) throw std::runtime_error(std::to_string(i));
          });
        });
        ADD_FAILURE() << "nothing was thrown";
      } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "39");
      }
      for (std::size_t i = 0; i < calls.size(); ++i) {
        EXPECT_LE(calls[i], 1);
        EXPECT_TRUE(i > 39 || calls[i] == 1);
      }
    }
  }
  std::atomic<int> sum = 0;
  parallel_tasks(4, 100, [&](std::int64_t) { ++sum; });
  EXPECT_EQ(sum, 100);
}

TEST(Parallel, LoopsWithinTasksAndFromManyThreadsEnd) {
  std::atomic<std::int64_t> sum = 0;
  std::vector<std::jthread> callers;
  callers.reserve(4);
  for (int caller = 0; caller < 4; ++caller) {
    callers.emplace_back([&] {
      for (int repetition = 0; repetition < 200; ++repetition) {
        parallel_for(4, 10,
                     [&](std::int64_t) { parallel_for(4, 10, [&](std::int64_t i) { sum += i; }); });
      }
    });
  }
  callers.clear();
  EXPECT_EQ(sum, 4 * 200 * 10 * 45);
}

/// Both tasks of a loop run at a time in the child of a fork, in whatever other threads were then.
TEST(Parallel, ForksHaveThreadsOfTheirOwn) {
  const auto meet = [] {
    std::atomic<int> here = 0;
    parallel_tasks(2, 2, [&](std::int64_t) {
      ++here;
      while (here < 2) std::this_thread::yield();
    });
  };
  meet();
  std::atomic<bool> goes_on = true;
  std::jthread other([&] {
    while (goes_on) parallel_tasks(4, 50, [](std::int64_t) {});
  });
  for (int n = 0; n < 20; ++n) {
    const pid_t child = fork();
    if (child == 0) {
      alarm(30);  // ends it where it waits for ever
      meet();
      _exit(0);
    }
    int status = -1;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
  }
  goes_on = false;
}

TEST(Parallel, RefusesNumbersOutOfRange) {
  EXPECT_EQ(thread_count(max_threads), max_threads);
  EXPECT_THROW(thread_count(max_threads + 1), std::invalid_argument);
  EXPECT_THROW(thread_count(-1), std::invalid_argument);
  EXPECT_EQ(thread_count(1), 1);
  EXPECT_GE(thread_count(0), 1);
}

/// Idle threads sleep: processor time of the process while it waits.
TEST(Parallel, IdleThreadsTakeNoProcessorTime) {
  parallel_tasks(4, 100, [](std::int64_t) {});
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const std::clock_t before = std::clock();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_LT(std::clock() - before, CLOCKS_PER_SEC / 50);
}
}  // namespace
}  // namespace tetwarp::test
