/// @file contact_coarse.cpp
#include "host/contact_coarse.hpp"

#include <algorithm>

namespace tetwarp {

namespace {

std::size_t index_of(std::int64_t i) {
  return static_cast<std::size_t>(i);
}

constexpr std::int64_t most_patches = 32;    // a dense factorization of 96 unknowns per Newton step
constexpr std::int64_t smallest_patch = 24;  // blocks

}  // namespace

CoarsePatches make_patches(const ContactStructure& structure, const ContactIsland& island) {
  const std::int64_t blocks = island.block_end - island.block_begin;
  const auto is_node = [&](std::int64_t b) {
    const std::size_t i = index_of(island.block_begin + b);
    return structure.dof_start[i + 1] - structure.dof_start[i] == 3;
  };
  const std::int64_t size = std::max(smallest_patch, (blocks + most_patches - 1) / most_patches);
  CoarsePatches patches;
  patches.patch.assign(index_of(blocks), -1);
  std::vector<std::int32_t> grown;
  for (std::int64_t seed = 0; seed < blocks; ++seed) {
    if (!is_node(seed) || patches.patch[index_of(seed)] >= 0) continue;
    const auto own = static_cast<std::int32_t>(patches.count);
    std::int32_t neighbor = -1;  // another patch met on the way
    grown.assign(1, static_cast<std::int32_t>(seed));
    patches.patch[index_of(seed)] = own;
    for (std::size_t next = 0; next < grown.size(); ++next) {
      const std::size_t row = index_of(island.block_begin + grown[next]);
      for (std::int64_t k = structure.system_row[row]; k < structure.system_row[row + 1]; ++k) {
        const std::int64_t b = structure.system_column[index_of(k)] - island.block_begin;
        if (!is_node(b)) continue;
        std::int32_t& patch = patches.patch[index_of(b)];
        if (patch >= 0 && patch != own) neighbor = patch;
        if (patch >= 0 || static_cast<std::int64_t>(grown.size()) >= size) continue;
        patch = own;
        grown.push_back(static_cast<std::int32_t>(b));
      }
    }
    // Scraps join a neighbor.
    if (neighbor >= 0 && 3 * static_cast<std::int64_t>(grown.size()) < size) {
      for (const std::int32_t b : grown) patches.patch[index_of(b)] = neighbor;
    } else {
      ++patches.count;
    }
  }
  return patches;
}

CoarseSpace::CoarseSpace(const ContactStructure& structure, const ContactIsland& island)
    : structure_(structure), island_(island), patches_(make_patches(structure, island)) {}

void CoarseSpace::set_system(const std::vector<double>& system) {
  matrix_.setZero(3 * patches_.count, 3 * patches_.count);
  with_contacts_ = matrix_;
  for (std::int64_t b = island_.block_begin; b < island_.block_end; ++b) {
    for (std::int64_t k = structure_.system_row[index_of(b)];
         k < structure_.system_row[index_of(b) + 1]; ++k) {
      add(b, structure_.system_column[index_of(k)],
          system.data() + structure_.system_value[index_of(k)]);
    }
  }
  matrix_ = with_contacts_;
}

void CoarseSpace::add(std::int64_t block, std::int64_t other, const double* entry) {
  const Eigen::Index row = patches_.patch[index_of(block - island_.block_begin)];
  const Eigen::Index column = patches_.patch[index_of(other - island_.block_begin)];
  if (row < 0 || column < 0) return;
  with_contacts_.block<3, 3>(3 * row, 3 * column) +=
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(entry);
}

void CoarseSpace::add_correction(const double* r, double* z) const {
  if (patches_.count == 0) return;
  const std::int64_t* dof_start = structure_.dof_start.data() + island_.block_begin;
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(3 * patches_.count);
  for (std::size_t b = 0; b < patches_.patch.size(); ++b) {
    if (patches_.patch[b] < 0) continue;
    const double* from = r + (dof_start[b] - island_.dof_begin);
    sums.segment<3>(3 * Eigen::Index{patches_.patch[b]}) += Eigen::Map<const Eigen::Vector3d>(from);
  }
  factor_.solveInPlace(sums);
  for (std::size_t b = 0; b < patches_.patch.size(); ++b) {
    if (patches_.patch[b] < 0) continue;
    double* to = z + (dof_start[b] - island_.dof_begin);
    Eigen::Map<Eigen::Vector3d> target(to);
    target += sums.segment<3>(3 * Eigen::Index{patches_.patch[b]});
  }
}

}  // namespace tetwarp
