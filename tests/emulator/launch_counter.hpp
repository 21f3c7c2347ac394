/// @file launch_counter.hpp
/// Counts what the kernels of emulated launches do: operations, requests of memory and the sectors
/// that they touch, barriers, lanes that wait for others.
///
/// Kernels call the counter from every basic block and every access to memory, where their files
/// are compiled with -fsanitize=kernel-address and -fsanitize-coverage=trace-pc (TETWARP_COUNTED in
/// cmake/Tests.cmake); its own file is not. What the lanes of a warp execute between two
/// synchronizations counts as executed together: the n-th visit of a block or access by any lane is
/// one of the warp.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tests/emulator/launch_observer.hpp"

namespace tetwarp::simt {

/// What a launch did; of a sample of its blocks scaled to all of them.
struct LaunchCounts {
  std::string kernel;
  std::int64_t blocks = 0, threads = 0;  ///< threads of a block
  double operations = 0;                 ///< weights of what warps executed, and accesses: one each
  double lane_operations = 0;            ///< of what lanes executed: at most 32 times as much
  double longest_warp = 0;               ///< operations of the warp that has most
  double barriers = 0;                   ///< of blocks
  double requests = 0;                   ///< of warps to memory of the device
  double sectors = 0;                    ///< of 32 bytes, touched by each request
  double least_sectors = 0;              ///< that would hold the different bytes of each request
  double block_bytes = 0;                ///< in different sectors of each block
  double bytes = 0;                      ///< the same, but of each allocation at most its size
};

/// Which blocks of a launch are counted.
struct LaunchSample {
  std::int64_t one_in = 1;  ///< one block in so many
  bool runs_others = true;  ///< else only the counted ones run
  double times = 1;         ///< so many launches that the counts stand for
};

/// Counts while it is LaunchObserver::current().
class LaunchCounter : public LaunchObserver {
 public:
  /// Operations of the basic blocks, by the address to which their call of the counter returns.
  using Weights = std::map<std::uintptr_t, double>;
  using Ranges = std::vector<std::pair<std::uintptr_t, std::uintptr_t>>;
  using SampleOf = std::function<LaunchSample(const std::string& kernel, std::int64_t blocks)>;

  /// @param weights  of basic blocks, 0 for those left out; empty: 1 for every one
  /// @param ranges   returns the allocations of the device, ascending
  /// @param sample   of a launch of a kernel with so many blocks
  LaunchCounter(Weights weights, std::function<Ranges()> ranges, SampleOf sample);

  /// The launches since the last call of this function.
  std::vector<LaunchCounts> take();
  /// Whether to count; if not, the same blocks run.
  bool counts = true;

  void launch_begins(const std::string& kernel, std::int64_t blocks, std::int64_t threads) override;
  bool runs(std::int64_t block) override;
  void lane_begins(const void* stack, std::size_t size) override;
  void lane_ends() override;
  void warp_paused(unsigned first) override;
  void barrier_passed() override { now_.barriers += is_counted_ ? 1 : 0; }
  void block_ends() override;
  void launch_ends() override;

  /// The running lane enters a basic block.
  void visit(std::uintptr_t from);
  /// The running lane reads or writes memory: shared memory or that of the device, unless it is a
  /// local variable, which a device has in registers.
  void access(std::uintptr_t from, std::uintptr_t address, std::size_t size);

 private:
  /// A place of the program that calls the counter.
  struct Point {
    double weight = 0;
    int of_lane = 0;            ///< visits of the running lane
    int most = 0;               ///< of a lane of the warp since its last synchronization
    std::int64_t sum = 0;       ///< of all its lanes
    std::vector<int> requests;  ///< by visit
  };
  /// The same visit of an access by the lanes of a warp.
  struct Request {
    std::array<std::uintptr_t, 32> addresses;
    std::size_t count = 0, size = 0;
  };

  Point& point(std::uintptr_t from);
  void add_to_request(Point& point, std::uintptr_t address, std::size_t size);
  void count_visit(Point& point);
  void count_request(const Request& request);
  /// Number of the allocation that holds an address; -1 for none.
  int range_of(std::uintptr_t address);

  Weights weights_;
  std::function<Ranges()> find_ranges_;
  SampleOf find_sample_;
  std::vector<int> numbers_;  ///< of points, by address of the program; 0: none yet
  std::vector<Point> points_;
  std::vector<Point*> of_lane_, of_warp_;
  std::vector<Request> requests_;  ///< of which the first request_count_ are used
  std::size_t request_count_ = 0;
  std::uintptr_t stack_ = 0;  ///< of the running lane
  std::size_t stack_size_ = 0;
  Ranges ranges_;
  std::size_t last_range_ = 0;
  std::vector<std::uintptr_t> block_sectors_;
  std::vector<std::int64_t> range_sectors_;
  std::vector<double> warp_operations_;
  LaunchSample sample_;
  std::int64_t counted_ = 0;  ///< blocks
  bool is_counted_ = false;   ///< the running block is
  LaunchCounts now_;
  std::vector<LaunchCounts> done_;
};

}  // namespace tetwarp::simt
