#include "tests/emulator/launch_counter.hpp"

#include <algorithm>
#include <utility>

#include "host/base/counter_hash.hpp"

// Ends of the program's code, from the linker.
extern "C" const char __executable_start, etext;  // NOLINT: names of the linker

namespace tetwarp::simt {
namespace {
constexpr std::uintptr_t sector = 32;
LaunchCounter* running = nullptr;  ///< counts for the lane that runs

std::uintptr_t first_code() {
  return reinterpret_cast<std::uintptr_t>(&__executable_start);
}
std::uintptr_t past_code() {
  return reinterpret_cast<std::uintptr_t>(&etext);
}
}  // namespace

LaunchCounter::LaunchCounter(Weights weights, std::function<Ranges()> ranges, SampleOf sample)
    : weights_(std::move(weights)),
      find_ranges_(std::move(ranges)),
      find_sample_(std::move(sample)),
      numbers_(past_code() - first_code(), 0) {
  points_.reserve(std::size_t{1} << 20);  // pointers to points stay valid
  points_.emplace_back();
}

std::vector<LaunchCounts> LaunchCounter::take() {
  return std::exchange(done_, {});
}

void LaunchCounter::launch_begins(const std::string& kernel,
                                  std::int64_t blocks,
                                  std::int64_t threads) {
  now_ = {};
  now_.kernel = kernel;
  now_.blocks = blocks;
  now_.threads = threads;
  sample_ = find_sample_(kernel, blocks);
  counted_ = 0;
  ranges_ = find_ranges_();
  range_sectors_.assign(ranges_.size(), 0);
  last_range_ = 0;
  warp_operations_.assign(static_cast<std::size_t>((threads + 31) / 32), 0.0);
}

/// One of each `one_in` successive blocks, of which some may be missing at the end.
bool LaunchCounter::runs(std::int64_t block) {
  const std::int64_t group = block / sample_.one_in;
  const double place =
      unit_of(static_cast<std::uint64_t>(group)) * static_cast<double>(sample_.one_in);
  const bool is_chosen = block % sample_.one_in == static_cast<std::int64_t>(place);
  is_counted_ = counts && is_chosen;
  counted_ += is_chosen ? 1 : 0;
  return is_chosen || sample_.runs_others;
}

void LaunchCounter::lane_begins(const void* stack, std::size_t size) {
  stack_ = reinterpret_cast<std::uintptr_t>(stack);
  stack_size_ = size;
  if (is_counted_) running = this;
}

void LaunchCounter::lane_ends() {
  running = nullptr;
  for (Point* const point : of_lane_) {
    if (point->sum == 0) of_warp_.push_back(point);
    point->most = std::max(point->most, point->of_lane);
    point->sum += point->of_lane;
    point->of_lane = 0;
  }
  of_lane_.clear();
}

void LaunchCounter::warp_paused(unsigned first) {
  if (!is_counted_) return;
  double operations = 1;  // the synchronization itself, or the end
  for (Point* const point : of_warp_) {
    operations += point->weight * point->most;
    now_.lane_operations += point->weight * static_cast<double>(point->sum);
    point->most = 0;
    point->sum = 0;
    point->requests.clear();
  }
  of_warp_.clear();
  now_.operations += operations;
  warp_operations_[first / 32] += operations;
  for (std::size_t r = 0; r < request_count_; ++r) {
    if (requests_[r].count > 0) count_request(requests_[r]);
  }
  request_count_ = 0;
}

void LaunchCounter::block_ends() {
  for (double& operations : warp_operations_) {
    now_.longest_warp = std::max(now_.longest_warp, operations);
    operations = 0;
  }
  std::ranges::sort(block_sectors_);
  const auto repeated = std::ranges::unique(block_sectors_);
  block_sectors_.erase(repeated.begin(), repeated.end());
  for (const std::uintptr_t s : block_sectors_) {
    ++range_sectors_[static_cast<std::size_t>(range_of(s * sector))];
  }
  block_sectors_.clear();
}

void LaunchCounter::launch_ends() {
  const double times = sample_.times * static_cast<double>(now_.blocks) /
                       static_cast<double>(std::max<std::int64_t>(counted_, 1));
  for (double* const sum : {&now_.operations, &now_.lane_operations, &now_.barriers, &now_.requests,
                            &now_.sectors, &now_.least_sectors}) {
    *sum *= times;
  }
  for (std::size_t r = 0; r < ranges_.size(); ++r) {
    const double touched =
        times * static_cast<double>(sector) * static_cast<double>(range_sectors_[r]);
    now_.block_bytes += touched;
    now_.bytes += std::min(touched, static_cast<double>(ranges_[r].second - ranges_[r].first));
  }
  done_.push_back(now_);
}

void LaunchCounter::visit(std::uintptr_t from) {
  count_visit(point(from));
}

void LaunchCounter::access(std::uintptr_t from, std::uintptr_t address, std::size_t size) {
  const bool is_on_device = range_of(address) >= 0;
  if (!is_on_device && address - stack_ < stack_size_) return;
  Point& here = point(from);
  if (is_on_device) add_to_request(here, address, size);
  count_visit(here);
}

void LaunchCounter::add_to_request(Point& point, std::uintptr_t address, std::size_t size) {
  const auto visit = static_cast<std::size_t>(point.of_lane);
  while (point.requests.size() <= visit) {
    if (request_count_ == requests_.size()) requests_.emplace_back();
    requests_[request_count_].count = 0;
    requests_[request_count_].size = size;
    point.requests.push_back(static_cast<int>(request_count_++));
  }
  Request& request = requests_[static_cast<std::size_t>(point.requests[visit])];
  request.addresses[request.count++] = address;
}

LaunchCounter::Point& LaunchCounter::point(std::uintptr_t from) {
  int& number = numbers_[from - first_code()];
  if (number == 0) {
    number = static_cast<int>(points_.size());
    points_.emplace_back();
    const auto known = weights_.find(from);
    const double weight = known != weights_.end() ? known->second : weights_.empty() ? 1.0 : 0.0;
    points_.back().weight = weight;
  }
  return points_[static_cast<std::size_t>(number)];
}

void LaunchCounter::count_visit(Point& point) {
  if (point.of_lane++ == 0) of_lane_.push_back(&point);
}

void LaunchCounter::count_request(const Request& request) {
  std::array<std::uintptr_t, 32> addresses = request.addresses;
  const auto end = addresses.begin() + static_cast<std::ptrdiff_t>(request.count);
  std::sort(addresses.begin(), end);
  const auto different =
      static_cast<std::size_t>(std::unique(addresses.begin(), end) - addresses.begin());
  std::size_t sectors = 0;
  std::uintptr_t next = 0;  // sectors before it are counted
  for (std::size_t a = 0; a < different; ++a) {
    const std::uintptr_t last = (addresses[a] + request.size - 1) / sector;
    for (std::uintptr_t s = std::max(addresses[a] / sector, next); s <= last; ++s) {
      block_sectors_.push_back(s);
      ++sectors;
      next = s + 1;
    }
  }
  ++now_.requests;
  now_.sectors += static_cast<double>(sectors);
  now_.least_sectors += static_cast<double>((different * request.size + sector - 1) / sector);
}

int LaunchCounter::range_of(std::uintptr_t address) {
  const auto holds = [&](std::size_t range) {
    return address >= ranges_[range].first && address < ranges_[range].second;
  };
  if (last_range_ < ranges_.size() && holds(last_range_)) return static_cast<int>(last_range_);
  const auto after =
      std::ranges::upper_bound(ranges_, address, {}, [](const auto& range) { return range.first; });
  if (after == ranges_.begin()) return -1;
  const auto range = static_cast<std::size_t>(after - ranges_.begin()) - 1;
  if (!holds(range)) return -1;
  last_range_ = range;
  return static_cast<int>(range);
}
}  // namespace tetwarp::simt

// NOLINTBEGIN(bugprone-reserved-identifier, readability-identifier-naming): called by the compiler
namespace {
std::uintptr_t address_of(const void* place) {
  return reinterpret_cast<std::uintptr_t>(place);
}
void note_access(const void* from, const void* address, std::size_t size) {
  if (tetwarp::simt::running != nullptr) {
    tetwarp::simt::running->access(address_of(from), address_of(address), size);
  }
}
}  // namespace

extern "C" {
void __asan_handle_no_return() {}
void __asan_before_dynamic_init(const char*) {}
void __asan_after_dynamic_init() {}
void __sanitizer_cov_trace_pc() {
  if (tetwarp::simt::running != nullptr) {
    tetwarp::simt::running->visit(address_of(__builtin_return_address(0)));
  }
}
void __asan_load1_noabort(const void* address) {
  note_access(__builtin_return_address(0), address, 1);
}
void __asan_load2_noabort(const void* address) {
  note_access(__builtin_return_address(0), address, 2);
}
void __asan_load4_noabort(const void* address) {
  note_access(__builtin_return_address(0), address, 4);
}
void __asan_load8_noabort(const void* address) {
  note_access(__builtin_return_address(0), address, 8);
}
void __asan_load16_noabort(const void* address) {
  note_access(__builtin_return_address(0), address, 16);
}
void __asan_loadN_noabort(const void* address, std::size_t size) {
  note_access(__builtin_return_address(0), address, size);
}
void __asan_store1_noabort(const void* address) {
  note_access(__builtin_return_address(0), address, 1);
}
void __asan_store2_noabort(const void* address) {
  note_access(__builtin_return_address(0), address, 2);
}
void __asan_store4_noabort(const void* address) {
  note_access(__builtin_return_address(0), address, 4);
}
void __asan_store8_noabort(const void* address) {
  note_access(__builtin_return_address(0), address, 8);
}
void __asan_store16_noabort(const void* address) {
  note_access(__builtin_return_address(0), address, 16);
}
void __asan_storeN_noabort(const void* address, std::size_t size) {
  note_access(__builtin_return_address(0), address, size);
}
}
// NOLINTEND(bugprone-reserved-identifier, readability-identifier-naming)
