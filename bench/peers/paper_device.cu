#include <memory>

#include "bench/peers/paper_device.cuh"
#include "bench/peers/paper_device.hpp"

namespace tetwarp::bench {

PaperDeviceSteps paper_method_on_device(const PeerInput& input, bool with_cells) {
  const auto held = std::make_shared<PaperOnDevice>(input, with_cells);
  return {[held] { held->step(); }, [held, to = input.output] { held->get(to); }};
}

}  // namespace tetwarp::bench
