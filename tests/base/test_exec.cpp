/// @file test_exec.cpp
/// The operations of a pipeline give the same results on every executor.
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "kernels/base/plain_sums.hpp"
#include "tests/support/each_exec.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {

struct SquareOp {
  View<std::int64_t> values;
  TETWARP_HD void operator()(std::int64_t i) const { values[i] += i * i; }
};

struct PlaceOp {
  View<std::int64_t> segments;
  View<std::int64_t> locals;
  TETWARP_HD void operator()(std::int64_t segment, std::int64_t local, std::int64_t item) const {
    segments[item] += segment;
    locals[item] += local;
  }
};

/// Each third index appends itself, each ninth a second time; all tally one.
struct ThirdsOp {
  template <class Emit>
  TETWARP_HD void operator()(std::int64_t i, Emit& emit) const {
    emit.tally(1);
    if (i % 3 == 0) emit(i);
    if (i % 9 == 0) emit(-i);
  }
};

struct EntryOp {
  View<const double> values;
  TETWARP_HD PlainSums<1> operator()(std::int64_t i) const { return {{values[i]}}; }
};

namespace {
/// Segment lengths 0 to 4, many of them empty.
std::vector<std::int64_t> uneven_lengths(std::int64_t segments) {
  std::vector<std::int64_t> lengths;
  for (std::int64_t s = 0; s < segments; ++s) {
    const double u = scenes::uniform(5, static_cast<std::uint64_t>(s));
    lengths.push_back(u < 0.4 ? 0 : static_cast<std::int64_t>(6 * u) - 1);
  }
  return lengths;
}

/// Pairs of unordered cells below `cells`; every fourth is rejected.
std::vector<CellPair> unordered_pairs(std::int64_t count, std::int64_t cells) {
  std::vector<CellPair> pairs;
  for (std::int64_t p = 0; p < count; ++p) {
    const double u = scenes::uniform(9, static_cast<std::uint64_t>(p));
    const auto cell = static_cast<std::int64_t>(u * static_cast<double>(cells));
    pairs.push_back(p % 4 == 3 ? rejected_pair : make_pair(cell, p, p % 3 == 0));
  }
  return pairs;
}

template <class Exec>
class Executor : public EachExec<Exec> {};
TYPED_TEST_SUITE(Executor, Execs, ExecNames);

TYPED_TEST(Executor, ForEachVisitsEveryIndexOnce) {
  for (const std::int64_t size : {0, 1, 31, 32, 33, 1025, 5000}) {
    const auto values = this->template zeros<std::int64_t>(size);
    std::vector<std::int64_t> squares(static_cast<std::size_t>(size));
    for (std::size_t i = 0; i < squares.size(); ++i) {
      squares[i] = static_cast<std::int64_t>(i * i);
    }

    this->exec().for_each("test", size, SquareOp{values});

    EXPECT_EQ(this->download(values), squares);
  }
}

TYPED_TEST(Executor, ForEachItemPassesSegmentAndPlace) {
  for (const std::int64_t segment_count : {1, 31, 32, 33, 1025, 9000}) {
    std::vector<std::int64_t> offsets = {0}, segments, locals;
    for (const std::int64_t length : uneven_lengths(segment_count)) {
      for (std::int64_t local = 0; local < length; ++local) {
        segments.push_back(static_cast<std::int64_t>(offsets.size()) - 1);
        locals.push_back(local);
      }
      offsets.push_back(offsets.back() + length);
    }
    const std::int64_t items = offsets.back();
    const PlaceOp body{this->template zeros<std::int64_t>(items),
                       this->template zeros<std::int64_t>(items)};

    this->exec().for_each_item("test", this->upload(offsets), items, body);

    EXPECT_EQ(this->download(body.segments), segments);
    EXPECT_EQ(this->download(body.locals), locals);
  }
}

TYPED_TEST(Executor, ForEachItemLeavesOutWhatHasNoRoom) {
  const auto offsets = this->upload(std::vector<std::int64_t>{0, 2, 2, 5});
  const PlaceOp body{this->template zeros<std::int64_t>(5), this->template zeros<std::int64_t>(5)};

  this->exec().for_each_item("test", offsets, 3, body);

  EXPECT_EQ(this->download(body.segments), (std::vector<std::int64_t>{0, 0, 2, 0, 0}));
}

TYPED_TEST(Executor, ScanSumsWhatLiesBeforeAndIgnoresTheLastEntry) {
  for (const std::int64_t size : tricky_sizes) {
    std::vector<std::int64_t> values = uneven_lengths(size);
    values.push_back(-77);
    std::vector<std::int64_t> sums(values.size());
    std::exclusive_scan(values.begin(), values.end(), sums.begin(), std::int64_t{0});
    const auto view = this->upload(values);

    this->exec().exclusive_scan("test", view);

    EXPECT_EQ(this->download(view), sums);
  }
}

TYPED_TEST(Executor, SumAddsEveryEntryOfItsRange) {
  for (const std::int64_t size : {0, 1, 31, 32, 33, 1025, 5000}) {
    std::vector<double> values(static_cast<std::size_t>(size));
    std::iota(values.begin(), values.end(), 1.0);
    const EntryOp body{this->upload(values)};
    const std::int64_t first = std::min<std::int64_t>(size, 3);
    const auto sum = this->exec().template sum<PlainSums<1>>("test", first, size, body);

    EXPECT_EQ(sum.value[0], std::accumulate(values.begin() + first, values.end(), 0.0));
  }
}

TYPED_TEST(Executor, ListsAreInTheOrderOfWhatAppends) {
  typename TypeParam::template List<std::int64_t> list;
  for (const std::int64_t size : {5000, 0, 1, 31, 32, 33, 1025}) {
    std::vector<std::int64_t> expected;
    for (std::int64_t i = 0; i < size; i += 3) {
      expected.push_back(i);
      if (i % 9 == 0) expected.push_back(-i);
    }

    this->exec().append("test", size, ThirdsOp{}, list);

    EXPECT_EQ(this->download(list.view()), expected);
    EXPECT_EQ(list.tally(), size);
    const auto count = static_cast<std::int64_t>(expected.size());
    EXPECT_NO_THROW(this->exec().append("test", size, ThirdsOp{}, list, count));
    if (size == 0) continue;
    EXPECT_THROW(this->exec().append("test", size, ThirdsOp{}, list, count - 1), TooManyPairs);
  }
}

TYPED_TEST(Executor, VectorsHoldWhatIsPutUntilTheyAreMadeZero) {
  typename TypeParam::template Vector<std::int64_t> values;
  const std::vector<std::int64_t> numbers = {3, 1, 4, 1, 5};
  this->exec().put(numbers.data(), 5, values);
  EXPECT_EQ(this->download(this->exec().view(values)), numbers);

  this->exec().make_zeros(values, 7);
  EXPECT_EQ(this->download(this->exec().view(values)), std::vector<std::int64_t>(7));

  this->exec().resize(values, 2);
  EXPECT_EQ(this->exec().view(values).size, 2);
}

TEST(ExecutorCpu, SelectKeepsValidPairsInTheirOrder) {
  CpuExec exec(2);
  for (const std::int64_t size : tricky_sizes) {
    const std::vector<CellPair> candidates = unordered_pairs(size, 50);
    std::vector<CellPair> valid;
    std::ranges::copy_if(candidates, std::back_inserter(valid),
                         [](CellPair p) { return p != rejected_pair; });
    std::vector<CellPair> pairs(candidates.size());
    std::int64_t kept = 0;

    exec.select_valid("test", {candidates.data(), size}, {&size, 1}, {pairs.data(), size},
                      {&kept, 1});

    pairs.resize(static_cast<std::size_t>(kept));
    EXPECT_EQ(pairs, valid);
  }
}

TYPED_TEST(Executor, SortIsStableByCell) {
  for (const std::int64_t size : tricky_sizes) {
    for (const int cell_bits : {1, 7, 11, 12, 23, 32}) {
      const std::int64_t cells = std::int64_t{1} << cell_bits;
      std::vector<CellPair> pairs = unordered_pairs(size, cells);
      std::erase(pairs, rejected_pair);
      std::vector<CellPair> sorted = pairs;
      std::ranges::stable_sort(sorted, {}, cell_of);
      const auto view = this->upload(pairs);
      const auto count = this->upload(std::vector<std::int64_t>{view.size});

      this->exec().sort_pairs("test", view, count, cell_bits);

      EXPECT_EQ(this->download(view), sorted);
    }
  }
}

TYPED_TEST(Executor, ZeroClearsItsViewAndNoMore) {
  const auto values = this->upload(std::vector<std::int64_t>(40, 7));
  std::vector<std::int64_t> expected(40, 7);
  std::fill_n(expected.begin(), 33, 0);

  this->exec().zero("test", View<std::int64_t>{values.data, 33});

  EXPECT_EQ(this->download(values), expected);
}

TYPED_TEST(Executor, DeliversWhatWasWritten) {
  std::vector<std::int64_t> results(33, -1);
  typename TypeParam::template Buffer<std::int64_t> buffer;
  std::int64_t* const place = this->exec().writable(results.data(), 33, buffer);
  std::vector<std::int64_t> squares(33);
  for (std::size_t i = 0; i < 33; ++i) squares[i] = static_cast<std::int64_t>(i * i);

  this->exec().zero("test", View<std::int64_t>{place, 33});
  this->exec().for_each("test", 33, SquareOp{{place, 33}});
  this->exec().end_compute(true);
  this->exec().download("test", reinterpret_cast<const std::byte*>(place),
                        reinterpret_cast<std::byte*>(results.data()), {8, 33, 33, 1});
  this->exec().end_download();
  this->exec().wait_delivered();

  EXPECT_EQ(results, squares);
}

TYPED_TEST(Executor, ChargesTimeToTheLabelUntilCleared) {
  const auto values = this->template zeros<std::int64_t>(100000);

  this->exec().for_each("test/square", values.size, SquareOp{values});

  EXPECT_GT(this->exec().times().of("test/square"), 0);
  EXPECT_EQ(this->exec().times().of("test/other"), 0);
  this->exec().times().clear();
  EXPECT_EQ(this->exec().times().of("test/square"), 0);
}

TEST(ExecutorCpu, SumsAreTheSameForAnyNumberOfThreads) {
  std::vector<double> values;
  for (std::uint64_t i = 0; i < 5000; ++i) values.push_back(scenes::uniform(11, i));
  const EntryOp body{{values.data(), std::ssize(values)}};
  const double one = CpuExec(1).sum<PlainSums<1>>("test", 7, 5000, body).value[0];

  EXPECT_EQ(CpuExec(2).sum<PlainSums<1>>("test", 7, 5000, body).value[0], one);
  EXPECT_EQ(CpuExec(7).sum<PlainSums<1>>("test", 7, 5000, body).value[0], one);
}

TEST(ExecutorCpu, SortsTheSameForAnyNumberOfThreads) {
  std::vector<CellPair> pairs = unordered_pairs(5000, 300);
  std::erase(pairs, rejected_pair);
  std::vector<std::int64_t> count = {static_cast<std::int64_t>(pairs.size())};
  std::vector<CellPair> sorted = pairs;
  std::ranges::stable_sort(sorted, {}, cell_of);

  for (const int threads : {1, 2, 7}) {
    CpuExec exec(threads);
    std::vector<CellPair> mine = pairs;
    exec.sort_pairs("test", {mine.data(), count[0]}, {count.data(), 1}, 9);
    EXPECT_EQ(mine, sorted);
  }
}
}  // namespace
}  // namespace tetwarp::test
