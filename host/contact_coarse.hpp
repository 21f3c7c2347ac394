/// @file contact_coarse.hpp
/// Coarse space of a coupled system: patches of nodes that move as one, so that slow, wide modes do
/// not cost conjugate gradients many iterations.
#pragma once
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "host/contact_structure.hpp"

namespace tetwarp {

/// Patches of an island's blocks of 3 dofs, grown along A from the lowest free block; blocks of
/// other sizes (bodies) belong to none.
struct CoarsePatches {
  std::vector<std::int32_t> patch;  ///< of each block of the island, -1: none
  std::int64_t count = 0;
};

CoarsePatches make_patches(const ContactStructure& structure, const ContactIsland& island);

/// Z (Z^T A Z)^-1 Z^T with Z the translations of the patches.
class CoarseSpace {
 public:
  CoarseSpace(const ContactStructure& structure, const ContactIsland& island);

  /// Z^T A Z, from the numbers of A by blocks.
  void set_system(const std::vector<double>& system);

  /// Adds a contact's J^T S J between two blocks of the island, 3 x 3 row by row, to a copy that
  /// factorize() takes.
  void start_contacts() { with_contacts_ = matrix_; }
  void add(std::int64_t block, std::int64_t other, const double* entry);
  void factorize() { factor_.compute(with_contacts_); }

  /// z += Z (Z^T A Z)^-1 Z^T r, both [dofs of the island].
  void add_correction(const double* r, double* z) const;

 private:
  const ContactStructure& structure_;
  const ContactIsland& island_;
  CoarsePatches patches_;
  Eigen::MatrixXd matrix_, with_contacts_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

}  // namespace tetwarp
