/// @file part_exchange.hpp
/// Blocks and reports that ranks send to the root.
#pragma once
#include <memory>

#include "host/cli/common/ranks.hpp"
#include "host/cli/warp/volumes/volume_part.hpp"
#include "host/cli/warp/volumes/volume_task.hpp"

namespace tetwarp::cli {

class PartExchange {
 public:
  /// @param task, ranks  kept by the caller
  PartExchange(const VolumeTask& task, Ranks& ranks) : task_(task), ranks_(ranks) {}

  /// Begins to send a block to the root. Waits until the root has received the previous one.
  void send(const VolumePart& part);
  /// Waits until the root has received the last block.
  void finish_sending();
  /// Receives the samples of a block. Used by the root.
  std::shared_ptr<Samples> receive(const Region& region, int from) const;

  /// Adds the reports of all ranks to that of the root.
  void add_reports(StepReport& report) const;

 private:
  const VolumeTask& task_;
  Ranks& ranks_;
  std::shared_ptr<Samples> sent_;  ///< being sent
};

}  // namespace tetwarp::cli
