/// @file compliant_list_maker.cpp
/// Lists rows and bodies of the islands, with a new version where they have changed.
#include "host/simulate/solve/two_level/compliant_list_maker.hpp"

#include <algorithm>
#include <atomic>
#include <utility>

#include "host/base/index_of.hpp"

namespace tetwarp {
namespace {

std::int64_t next_version() {
  static std::atomic<std::int64_t> last = 0;
  return ++last;
}

}  // namespace

CompliantListMaker::CompliantListMaker(std::vector<std::int32_t> body_of, double relaxation)
    : body_of_(std::move(body_of)), relaxation_(relaxation) {}

bool CompliantListMaker::is_made(const SystemRows& rows,
                                 const std::vector<std::uint8_t>& takes,
                                 const std::vector<std::uint8_t>& bare) const {
  const View<const std::int32_t>& of = rows.block_of;
  return takes == takes_ && bare == bare_ &&
         std::equal(of.data, of.data + of.size, block_of_.begin(), block_of_.end());
}

/// Whether A couples a row with those of another body of the lists.
/// @param elastic  elastic body that the row belongs to, or -1
bool CompliantListMaker::is_joined(const SystemRows& rows,
                                   std::int32_t row,
                                   std::int32_t elastic) const {
  const std::int32_t partner = rows.pair[row] == 1 ? row + 1 : rows.pair[row] == 2 ? row - 1 : row;
  return std::any_of(rows.column.data + rows.start[row], rows.column.data + rows.free_end[row],
                     [&](std::int32_t column) {
                       return elastic < 0 ? column != row && column != partner
                                          : body_of_[index_of(rows.block_of[column])] != elastic;
                     });
}

/// Rows of an elastic body follow each other, and so do the two rows of a rigid body.
void CompliantListMaker::make(const SystemRows& rows,
                              const ContactIslands& islands,
                              const std::vector<std::uint8_t>& takes,
                              const std::vector<std::uint8_t>& bare) {
  if (is_made(rows, takes, bare)) return;
  takes_ = takes;
  bare_ = bare;
  block_of_.assign(rows.block_of.data, rows.block_of.data + rows.block_of.size);
  lists_.version = next_version();
  for (auto* list : {&lists_.model_body, &lists_.body_of_row, &lists_.system_row,
                     &lists_.model_block, &lists_.diagonal_rows}) {
    list->clear();
  }
  lists_.bodies.clear();
  lists_.row_of_block.assign(block_of_.size(), -1);
  const auto size_of = [](const std::vector<std::int32_t>& list) {
    return static_cast<std::int32_t>(list.size());
  };
  std::int32_t last = -1;
  for (std::int32_t row = 0; row < rows.unknown_count; ++row) {
    const std::int32_t block = rows.block_of[row], island = islands.of_block(block);
    if (takes[index_of(island)] == 0) continue;
    std::int32_t elastic = body_of_[index_of(block)];
    if (elastic >= 0 && !bare.empty() && bare[index_of(elastic)] != 0) elastic = -1;
    if (elastic >= 0 ? elastic != last : rows.pair[row] != 2) {
      CompliantBody& own = lists_.bodies.emplace_back();
      own.system_row = row;
      own.first = size_of(lists_.body_of_row);
      if (elastic >= 0) {
        own.frame = size_of(lists_.model_body);
        lists_.model_body.push_back(elastic);
      } else {
        own.relaxation = islands.is_coupled(island) ? relaxation_ : 1;
        lists_.diagonal_rows.push_back(row);
      }
    }
    last = elastic;
    CompliantBody& body = lists_.bodies.back();
    ++body.count;
    body.is_joined = body.is_joined || is_joined(rows, row, elastic);
    lists_.row_of_block[index_of(block)] = size_of(lists_.body_of_row);
    lists_.body_of_row.push_back(static_cast<std::int32_t>(lists_.bodies.size()) - 1);
    lists_.system_row.push_back(row);
    lists_.model_block.push_back(block);
  }
}

}  // namespace tetwarp
