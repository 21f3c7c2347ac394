/// @file test_checkpoint_bytes.cpp
/// Values in the bytes of a checkpoint: what was written is read, damaged bytes are refused.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/simulate/state/checkpoint_bytes.hpp"
#include "tests/support/message_of.hpp"

namespace tetwarp::test {
namespace {

struct StreamedRecord {
  std::string name;
  std::vector<double> numbers;
  std::map<std::string, std::int64_t> counts;
  std::optional<std::optional<double>> choice;
  bool flag = false;
  bool operator==(const StreamedRecord&) const = default;
};

template <class Stream, class Record>
void exchange_members(Stream& stream, Record& record) {
  auto& [name, numbers, counts, choice, flag] = record;
  stream(name, numbers, counts, choice, flag);
}

TEST(CheckpointBytes, AreReadAsTheyWereWritten) {
  for (const std::optional<std::optional<double>>& choice :
       {std::optional<std::optional<double>>{}, {std::optional<double>{}}, {0.5}}) {
    const StreamedRecord written{"a", {1, 2, 3}, {{"b", 4}, {"c", 5}}, choice, true};
    CheckpointWriter writer;
    writer(written);
    writer.pass_list(written.numbers, [](auto& of, const double& number) { of(number); });
    StreamedRecord read;
    read.numbers.resize(3);  // lists of numbers keep their lengths
    std::vector<double> list = {7};

    CheckpointReader reader(writer.bytes());
    reader(read);
    reader.pass_list(list, [](auto& of, double& number) { of(number); });

    EXPECT_TRUE(read == written);
    EXPECT_EQ(list, written.numbers);
    EXPECT_TRUE(reader.is_at_end());
  }
}

/// A list of a claimed length must not become an allocation.
TEST(CheckpointBytes, AreRefusedWhereTheyAreDamaged) {
  CheckpointWriter writer;
  writer(std::vector<double>(2), std::uint64_t{1} << 50);
  const auto complaint = [&](std::size_t skipped, auto value) {
    return message_of([&] { CheckpointReader(writer.bytes().subspan(skipped))(value); });
  };

  EXPECT_EQ(complaint(0, std::vector<double>(3)),
            "checkpoint: a list has 2 entries, the scene needs 3");
  EXPECT_EQ(complaint(0, false), "checkpoint: damaged, a flag is neither 0 nor 1");
  EXPECT_EQ(complaint(28, std::uint64_t{0}),
            "checkpoint: incomplete, 8 more bytes expected, got 4");
  EXPECT_EQ(complaint(24, std::map<int, int>{}),
            "checkpoint: incomplete, a list of 1125899906842624 entries expected");
}

}  // namespace
}  // namespace tetwarp::test
