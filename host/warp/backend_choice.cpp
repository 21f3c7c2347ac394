#include "host/warp/backend_choice.hpp"

#include <algorithm>

#include "host/base/parallel.hpp"
#include "host/warp/box_sums.hpp"
#include "host/warp/device_start.hpp"
#include "kernels/warp/sample/gaussian_label.hpp"

namespace tetwarp {
namespace {
/// Nanoseconds of a covered float32 voxel and a thread: rows analytic/128, labels/128 and W1 to W4
/// of bench/results/2026-11-24-epyc-2-cores.json, two threads each.
double nanoseconds_of(Filter filter) {
  switch (filter) {
    case Filter::nearest:
      return 6;
    case Filter::linear:
      return 8;
    case Filter::labels:
      return 16;
    case Filter::cubic:
    case Filter::bspline:
      return 50;
    default:
      return 95;
  }
}

/// The same of a label by Gaussian weights: a number for each label within the cutoff. Measured
/// with 27 to 4,913 of them on one thread of an AMD EPYC: 2 to 6, where labels differ everywhere 16
/// to 22.
double nanoseconds_of(const LabelGaussian& gaussian) {
  const double reach = std::min(gaussian.sigma * gaussian.cutoff, GaussianWindow::max_reach);
  const double along = 2 * reach + 1;
  return 5.5 * along * along * along;
}
}  // namespace

double estimated_cpu_seconds(const WarpOptions& options,
                             double samples,
                             bool has_hexahedra,
                             bool has_ten_nodes) {
  double nanoseconds = nanoseconds_of(options.filter);
  // docs/benchmarks.md, what features cost, over the plain step.
  if (options.antialias) nanoseconds *= 8;
  if (options.intensity == Intensity::density) nanoseconds *= 4;
  if (sums_boxes(options)) nanoseconds = 2100;
  if (takes_gaussian(options)) nanoseconds += nanoseconds_of(options.label_gaussian);
  if (has_hexahedra) nanoseconds += 220;
  if (has_ten_nodes) nanoseconds += 185;
  return 1e-9 * nanoseconds * samples / thread_count(options.threads);
}

std::pair<Backend, std::string> choose_backend_for(double cpu_seconds, const WarpOptions& options) {
  // Before the device's status, whose query starts the driver. What the device itself takes is left
  // out: it is less than a tenth of the cpu's time.
  if (options.backend == Backend::automatic && cpu_seconds < cuda_start_seconds(options.device)) {
    return {Backend::cpu, "the work is less than what a CUDA device takes to start"};
  }
  return choose_backend(options.backend, options.device);
}

}  // namespace tetwarp
