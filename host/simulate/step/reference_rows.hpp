/// @file reference_rows.hpp
/// The dense system of the reference as the sparse blocks of StepSystem.
#pragma once
#include <cstdint>
#include <vector>

#include "host/reference/simulate/assemble.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

class ReferenceRows {
 public:
  ReferenceRows() = default;
  /// @param blocks  [block_count] block of the reference of each block of the model
  ReferenceRows(const Model& model, std::vector<Eigen::Index> blocks);

  /// Takes the blocks that are not zero, and the diagonal.
  void set(const reference::LinearSystem& linear, const reference::VectorXd& velocity);
  /// The lists of what adds to a block are empty. Valid until the next set().
  StepSystem system() const;

 private:
  void add_row(const reference::LinearSystem& linear,
               const reference::VectorXd& velocity,
               std::int32_t row);

  std::vector<Eigen::Index> blocks_;
  std::int32_t unknown_count_ = 0;
  std::vector<std::int32_t> block_of_, start_, free_end_, column_, diagonal_;
  std::vector<std::uint8_t> pair_;
  std::vector<double> values_, load_, velocity_;
};

}  // namespace tetwarp
