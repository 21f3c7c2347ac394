/// @file two_level_sweeps.cpp
/// Which contacts are swept, how often, and the acceleration of their impulses.
#include "host/simulate/solve/two_level/two_level_sweeps.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/base/index_of.hpp"
#include "host/exec/exec_cpu.hpp"
#include "kernels/contact/anderson.hpp"

namespace tetwarp {
namespace {

// In an outer iteration; where sweeps converge slowly the next iteration goes on. With single
// elastic bodies most sweeps are over few groups, so that more of them take little time.
constexpr std::int64_t most_coupled_sweeps = 10, most_elastic_sweeps = 200;

}  // namespace

void TwoLevelSweeps::set(const ElasticSpace& elastic) {
  has_elastic_ = !elastic.bodies().empty();
  sweep_.set(elastic);
}

std::int64_t TwoLevelSweeps::most_sweeps() const {
  return has_elastic_ ? most_elastic_sweeps : most_coupled_sweeps;
}

/// Copies the impulses of `list`.
void TwoLevelSweeps::gather_impulses(const std::vector<std::int32_t>& list, const double* impulse) {
  swept_.clear();
  for (const std::int32_t contact : list) {
    const double* const own = impulse + 3 * std::ptrdiff_t{contact};
    swept_.insert(swept_.end(), own, own + 3);
  }
}

void TwoLevelSweeps::scatter_impulses(const std::vector<std::int32_t>& list,
                                      double* impulse) const {
  for (std::size_t k = 0; k < list.size(); ++k) {
    std::copy_n(swept_.begin() + 3 * static_cast<std::ptrdiff_t>(k), 3,
                impulse + 3 * std::ptrdiff_t{list[k]});
  }
}

bool TwoLevelSweeps::is_over(const Progress& progress) const {
  return progress.sweeps >= most_sweeps() || !progress.goes_on(progress.sweeps);
}

/// One sweep over the contacts that work. @returns the norm of the change in its energy
double TwoLevelSweeps::sweep_all(const std::vector<std::int32_t>& working,
                                 const Progress& progress) {
  gather_impulses(working, progress.impulse);
  before_ = swept_;
  sweep_.run(working, progress.y, swept_.data());
  group_squares_.assign(index_of(sweep_.group_count()), 0.0);
  for (std::size_t k = 0; k < working.size(); ++k) {
    double& square = group_squares_[index_of(sweep_.group_of(working[k]))];
    for (std::size_t a = 0; a < 3; ++a) {
      square += blocks_.diagonal()[3 * index_of(working[k]) + a] *
                square_of(swept_[3 * k + a] - before_[3 * k + a]);
    }
  }
  scatter_impulses(working, progress.impulse);
  return std::sqrt(std::accumulate(group_squares_.begin(), group_squares_.end(), 0.0));
}

/// Sweeps over `list`, accelerated, until a sweep changes its impulses by at most
/// `progress.enough` or the number of sweeps is at its limit.
/// @param follow  (accelerator): moves y as the accelerator has changed `swept_`
template <class Accelerator, class Follow>
void TwoLevelSweeps::sweep_accelerated(const std::vector<std::int32_t>& list,
                                       const Follow& follow,
                                       Progress& progress) {
  const auto size = static_cast<std::int64_t>(3 * list.size());
  CpuExec exec(threads_, StageClocks::off);
  accelerated_.resize(index_of(Accelerator::columns * size));
  listed_diagonal_.clear();
  for (const std::int32_t contact : list) {
    const auto begin = blocks_.diagonal().begin() + 3 * std::ptrdiff_t{contact};
    listed_diagonal_.insert(listed_diagonal_.end(), begin, begin + 3);
  }
  Accelerator accelerator(exec, {listed_diagonal_.data(), size},
                          {accelerated_.data(), Accelerator::columns * size});
  gather_impulses(list, progress.impulse);
  const View<double> image{swept_.data(), size};
  while (progress.sweeps < most_sweeps()) {
    before_ = swept_;
    motion_.keep(progress.y);
    const View<const double> before{before_.data(), size};
    sweep_.run(list, progress.y, swept_.data());
    ++progress.sweeps;
    accelerator.observe(before, image);
    if (accelerator.defect() <= progress.enough || is_over(progress)) break;
    unaccelerated_ = swept_;
    if (accelerator.advance(before, image)) follow(accelerator);
  }
  scatter_impulses(list, progress.impulse);
}

/// Conjugate directions follow impulses that drift, as those of many contacts between elastic
/// bodies do, whose velocities determine them poorly. Springs, which hold cloth, are linear:
/// Anderson acceleration finds their impulses sooner.
void TwoLevelSweeps::sweep_listed(const std::vector<std::int32_t>& list, Progress& progress) {
  using Directions = ConjugateDirection<CpuExec, double>;
  using Mixer = AndersonMixer<CpuExec, double>;
  moved_places_.clear();
  if (has_elastic_) sweep_.list_moved(list, moved_places_);
  motion_.start(moved_places_);
  if (has_elastic_) {
    const auto follow = [&](const Directions& directions) {
      motion_.advance(directions.state()->is_restart, directions.state()->ratio, progress.y);
    };
    sweep_accelerated<Directions>(list, follow, progress);
  } else {
    const auto follow = [&](const Mixer&) {
      blocks_.push(list, unaccelerated_.data(), swept_.data(), progress.y);
    };
    sweep_accelerated<Mixer>(list, follow, progress);
  }
}

/// Lists the contacts with impulses in groups that sweep_all() has changed. All other groups
/// together have changed by at most the half of `progress.enough`, in squares.
void TwoLevelSweeps::list_changing(const std::vector<std::int32_t>& working,
                                   const Progress& progress) {
  const double least =
      square_of(progress.enough) / (2.0 * static_cast<double>(group_squares_.size()));
  changing_.clear();
  for (const std::int32_t contact : working) {
    const double* const r = progress.impulse + 3 * std::ptrdiff_t{contact};
    if (!(group_squares_[index_of(sweep_.group_of(contact))] > least)) continue;
    if (r[0] != 0 || r[1] != 0 || r[2] != 0) changing_.push_back(contact);
  }
}

// Between sweeps over all contacts are those over the contacts with impulses only: a contact that
// is open stays so in most sweeps.
std::int64_t TwoLevelSweeps::run(std::vector<std::int32_t>& working,
                                 double enough,
                                 std::vector<double>& y,
                                 std::vector<double>& impulse,
                                 const std::function<bool(std::int64_t)>& goes_on) {
  Progress progress{y.data(), impulse.data(), enough, goes_on, 0};
  sweep_.begin(working);
  while (!working.empty() && !is_over(progress)) {
    ++progress.sweeps;
    if (sweep_all(working, progress) <= enough) break;
    list_changing(working, progress);
    const bool are_most = 4 * changing_.size() > 3 * working.size();
    sweep_listed(are_most ? working : changing_, progress);
    if (are_most) break;
  }
  return progress.sweeps;
}

}  // namespace tetwarp
