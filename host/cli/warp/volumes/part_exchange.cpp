/// @file part_exchange.cpp
/// Messages between ranks and the root.
#include "host/cli/warp/volumes/part_exchange.hpp"

#include <cstddef>
#include <string>
#include <vector>

#include "host/cli/warp/volumes/report_exchange.hpp"

namespace tetwarp::cli {

void PartExchange::send(const VolumePart& part) {
  ranks_.finish_sending();
  sent_ = part.outputs;
  for (std::size_t a = 0; a < sent_->size(); ++a) {
    ranks_.send({(*sent_)[a].get(), bytes_of(task_.outputs[a], part.region)});
  }
}

void PartExchange::finish_sending() {
  ranks_.finish_sending();
  sent_.reset();
}

std::shared_ptr<Samples> PartExchange::receive(const Region& region, int from) const {
  auto outputs = std::make_shared<Samples>(make_samples(task_.outputs, region));
  for (std::size_t a = 0; a < outputs->size(); ++a) {
    ranks_.receive(from, {(*outputs)[a].get(), bytes_of(task_.outputs[a], region)});
  }
  return outputs;
}

void PartExchange::add_reports(StepReport& report) const {
  const std::vector<std::string> reports = ranks_.gather(text_of(report));
  for (std::size_t r = 1; r < reports.size(); ++r) {
    const StepReport other = step_report_of(reports[r]);
    report.timings += other.timings;
    report.counts += other.counts;
  }
}

}  // namespace tetwarp::cli
