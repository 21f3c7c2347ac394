/// @file two_level_sweeps.cpp
/// The sweeps of an outer iteration of TwoLevelSolver.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/base/index_of.hpp"
#include "host/exec/contact_exec_cpu.hpp"
#include "host/simulate/solve/two_level/two_level_solver.hpp"

namespace tetwarp {
namespace {

// In an outer iteration; with single elastic bodies most sweeps are over few groups.
constexpr std::int64_t most_sweeps = 50, most_elastic_sweeps = 200;

}  // namespace

std::int64_t TwoLevelSolver::most_of_iteration() const {
  return elastic_.bodies().empty() ? most_sweeps : most_elastic_sweeps;
}

/// Copies the impulses of `list`.
void TwoLevelSolver::gather_impulses(const std::vector<std::int32_t>& list) {
  swept_.clear();
  for (const std::int32_t contact : list) {
    const auto begin = impulse_.begin() + 3 * std::ptrdiff_t{contact};
    swept_.insert(swept_.end(), begin, begin + 3);
  }
}

void TwoLevelSolver::scatter_impulses(const std::vector<std::int32_t>& list) {
  for (std::size_t k = 0; k < list.size(); ++k) {
    std::copy_n(swept_.begin() + 3 * static_cast<std::ptrdiff_t>(k), 3,
                impulse_.begin() + 3 * std::ptrdiff_t{list[k]});
  }
}

/// One sweep over the contacts that work. @returns the norm of the change in its energy
double TwoLevelSolver::sweep_working() {
  const std::vector<std::int32_t>& list = blocks_.working();
  gather_impulses(list);
  before_ = swept_;
  blocks_.sweep(switches_, list, y_.data(), swept_.data());
  group_squares_.assign(index_of(blocks_.group_count()), 0.0);
  for (std::size_t k = 0; k < list.size(); ++k) {
    double& square = group_squares_[index_of(blocks_.group_of(list[k]))];
    for (std::size_t a = 0; a < 3; ++a) {
      square += blocks_.diagonal()[3 * index_of(list[k]) + a] *
                square_of(swept_[3 * k + a] - before_[3 * k + a]);
    }
  }
  scatter_impulses(list);
  return std::sqrt(std::accumulate(group_squares_.begin(), group_squares_.end(), 0.0));
}

/// Sweeps over `list`, accelerated, until a sweep changes its impulses by at most `enough` or
/// `sweeps` is at its limit.
/// @param follow  (accelerator): moves y as the accelerator has changed `swept_`
template <class Accelerator, class Follow>
void TwoLevelSolver::sweep_accelerated(const std::vector<std::int32_t>& list,
                                       double enough,
                                       const Follow& follow,
                                       std::int64_t& sweeps) {
  const auto size = static_cast<std::int64_t>(3 * list.size());
  CpuContactExec exec(threads_);
  accelerated_.resize(index_of(Accelerator::columns * size));
  listed_diagonal_.clear();
  for (const std::int32_t contact : list) {
    const auto begin = blocks_.diagonal().begin() + 3 * std::ptrdiff_t{contact};
    listed_diagonal_.insert(listed_diagonal_.end(), begin, begin + 3);
  }
  Accelerator accelerator(exec, {listed_diagonal_.data(), size},
                          {accelerated_.data(), Accelerator::columns * size});
  gather_impulses(list);
  const std::int64_t most = most_of_iteration();
  const View<double> image{swept_.data(), size};
  while (sweeps < most) {
    before_ = swept_;
    motion_.keep(y_.data());
    const View<const double> before{before_.data(), size};
    blocks_.sweep(switches_, list, y_.data(), swept_.data());
    ++sweeps;
    accelerator.observe(before, image);
    if (accelerator.defect() <= enough || sweeps == most) break;
    unaccelerated_ = swept_;
    if (accelerator.advance(before, image)) follow(accelerator);
  }
  scatter_impulses(list);
}

/// Conjugate directions follow impulses that drift, as those of many contacts between elastic
/// bodies do, whose velocities determine them poorly. Springs, which hold cloth, are linear:
/// Anderson acceleration finds their impulses sooner.
void TwoLevelSolver::sweep_listed(const std::vector<std::int32_t>& list,
                                  double enough,
                                  std::int64_t& sweeps) {
  using Directions = ConjugateDirection<CpuContactExec, double>;
  using Mixer = AndersonMixer<CpuContactExec, double>;
  moved_places_.clear();
  if (elastic_.bodies().empty()) {
    motion_.start(moved_places_);
    sweep_accelerated<Mixer>(
        list, enough,
        [&](const Mixer&) { blocks_.push(list, unaccelerated_.data(), swept_.data(), y_.data()); },
        sweeps);
  } else {
    blocks_.list_moved(list, moved_places_);
    motion_.start(moved_places_);
    sweep_accelerated<Directions>(
        list, enough,
        [&](const Directions& directions) {
          motion_.advance(directions.state()->is_restart, directions.state()->ratio, y_.data());
        },
        sweeps);
  }
}

/// Sweeps until one over all contacts that work changes their impulses by at most `enough` in the
/// norm of their energy. Between these, sweeps over those with impulses only, as a contact that is
/// open stays so in most of them, and of these over groups that still change: all others together
/// by at most the half of `enough`, in squares. @returns the sweeps
std::int64_t TwoLevelSolver::sweep(double enough) {
  std::int64_t sweeps = 0;
  blocks_.begin_sweeps();
  const std::vector<std::int32_t>& working = blocks_.working();
  while (!working.empty() && sweeps < most_of_iteration()) {
    ++sweeps;
    if (sweep_working() <= enough) break;
    const double least = square_of(enough) / (2.0 * static_cast<double>(group_squares_.size()));
    pushing_.clear();
    for (const std::int32_t contact : working) {
      const double* const r = impulse_.data() + 3 * std::ptrdiff_t{contact};
      if (!(group_squares_[index_of(blocks_.group_of(contact))] > least)) continue;
      if (r[0] != 0 || r[1] != 0 || r[2] != 0) pushing_.push_back(contact);
    }
    const bool are_most = 4 * pushing_.size() > 3 * working.size();
    sweep_listed(are_most ? working : pushing_, enough, sweeps);
    if (are_most) break;
  }
  return sweeps;
}

}  // namespace tetwarp
