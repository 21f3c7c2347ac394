/// @file contact_krylov.hpp
/// Conjugate gradients for bodies that A couples, with contacts as springs: (A + J^T S J) x = g.
#pragma once
#include <cmath>
#include <cstdint>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "host/contact_accelerators.hpp"
#include "host/contact_coarse.hpp"
#include "host/contact_structure.hpp"
#include "host/contact_system.hpp"
#include "kernels/body_relax.hpp"
#include "kernels/contact_sweep.hpp"
#include "kernels/contact_tangent.hpp"

namespace tetwarp {

/// One index = one dof: x += a p, g += a q.
struct KrylovStepBody {
  double factor;
  const double *direction, *product;
  double *solution, *rest;

  TETWARP_HD void operator()(std::int64_t i) const {
    solution[i] += factor * direction[i];
    rest[i] += factor * product[i];
  }
};

/// One index = one dof: p = z + b p.
struct KrylovTurnBody {
  double factor;
  const double* from;
  double* direction;

  TETWARP_HD void operator()(std::int64_t i) const {
    direction[i] = from[i] + factor * direction[i];
  }
};

/// One index = one entry of a scalar product.
struct DotBody {
  const double *a, *b;

  TETWARP_HD PlainSums<1> operator()(std::int64_t i) const { return {{a[i] * b[i]}}; }
};

/// One index = one contact: -S J x, the force of its spring.
struct SpringForceBody {
  BodiesView<double> bodies;  ///< with offsets of zero
  View<const ContactTangent<double>> tangents;
  const double* x;
  View<double> force;

  TETWARP_HD void operator()(std::int64_t c) const {
    double change[3], spring[3];
    bodies.velocity_at(c, x, change);
    tangents[c].apply(change, spring);
    for (int a = 0; a < 3; ++a) force[3 * c + a] = -spring[a];
  }
};

/// One index = one block: its diagonal block of A + J^T S J, inverted; blocks without contacts keep
/// what they have.
struct SpringBlockBody {
  BlockContacts contacts;
  View<const std::int64_t> dof_start;
  View<const double> jacobian;
  View<const ContactTangent<double>> tangents;
  View<const std::int64_t> diagonal;  ///< [blocks], where A's diagonal block starts
  View<const double> system;
  View<const std::int64_t> inverse_start;
  View<double> inverse;

  TETWARP_HD void operator()(std::int64_t b) const {
    if (contacts.start[b] == contacts.start[b + 1]) return;
    const int size = static_cast<int>(dof_start[b + 1] - dof_start[b]);
    double* out = inverse.data + inverse_start[b];
    for (int e = 0; e < size * size; ++e) out[e] = system[diagonal[b] + e];
    for (std::int64_t p = contacts.start[b]; p < contacts.start[b + 1]; ++p) {
      const double* j = jacobian.data + contacts.value[p];
      for (int k = 0; k < size; ++k) {
        const double column[3] = {j[k], j[size + k], j[2 * size + k]};
        double pull[3];
        tangents[contacts.contact[p]].apply(column, pull);
        for (int i = 0; i < size; ++i) {
          out[i * size + k] += j[i] * pull[0] + j[size + i] * pull[1] + j[2 * size + i] * pull[2];
        }
      }
    }
    invert_spd(out, size);
  }
};

/// What a linear solve did.
struct KrylovStep {
  double energy_norm = 0;  ///< of the change of x
  double norm_ratio = 1;   ///< energy norm over the preconditioner's norm of the right-hand side
};

/// Linear systems of one coupled island. Vectors are [dofs] or [3 slots] of the whole problem; only
/// the island's part is read and written.
template <class Exec>
class CoupledSystem {
 public:
  using Vector = std::vector<double>;

  CoupledSystem(Exec& exec,
                const ContactStructure& structure,
                const ContactSystem<double>& system,
                const ContactIsland& island,
                CoarseSpace& coarse)
      : exec_(exec),
        structure_(structure),
        system_(system),
        island_(island),
        coarse_(coarse),
        zero_load_(system.load.size(), 0.0),
        zero_offset_(system.offset.size(), 0.0),
        force_(system.offset.size()),
        inverse_(system.inverse),
        tangents_(system.constants.size()),
        direction_(system.load.size()),
        product_(system.load.size()),
        image_(system.load.size()) {
    coarse_.set_system(system.system);
    set_tangents(tangents_);
  }

  /// Springs S of all contacts, [slots].
  void set_tangents(const std::vector<ContactTangent<double>>& tangents) {
    tangents_ = tangents;
    body_relax(exec_, island_.block_begin, island_.block_end,
               SpringBlockBody{structure_.block_contacts(), view_of(structure_.dof_start),
                               view_of(system_.jacobian), view_of(std::as_const(tangents_)),
                               view_of(structure_.diagonal_value), view_of(system_.system),
                               view_of(structure_.inverse_start), view_of(inverse_)});
    add_contacts_to_coarse();
    coarse_.factorize();
  }

  /// x += a solution for `rest`, which becomes what is left of it: `reduction` of it or less, in
  /// the norm of the preconditioner.
  /// @returns the energy norm of the change of x
  /// @throws ContactProblemError  A is not positive definite
  KrylovStep solve(double reduction, int most, Vector& rest, Vector& x) {
    precondition(rest, image_);
    direction_ = image_;
    double size = dot(rest, image_);
    const double aim = square_of(reduction) * size;
    const double start = size;
    double energy = 0;
    for (int k = 0; k < most && size > 0; ++k) {
      multiply(direction_, product_);
      const double curvature = -dot(direction_, product_);
      if (!(curvature > 0)) {
        throw ContactProblemError("system",
                                  ": not positive definite although its diagonal blocks are; give "
                                  "mass to every dof");
      }
      const double step = size / curvature;
      energy += step * size;
      for_dofs(KrylovStepBody{step, direction_.data(), product_.data(), x.data(), rest.data()});
      precondition(rest, image_);
      const double next = dot(rest, image_);
      if (next <= aim) break;
      for_dofs(KrylovTurnBody{next / size, image_.data(), direction_.data()});
      size = next;
    }
    return {std::sqrt(energy), start > 0 ? std::sqrt(energy / start) : 1};
  }

  /// Size of a defect g of A v = b + J^T r in the norm of the preconditioner: about the energy norm
  /// of the error of v.
  double size_of(const Vector& defect) {
    precondition(defect, image_);
    return std::sqrt(dot(defect, image_));
  }

  double dot(const Vector& a, const Vector& b) const {
    return exec_
        .template sum<PlainSums<1>>("contact/krylov", island_.dof_begin, island_.dof_end,
                                    DotBody{a.data(), b.data()})
        .value[0];
  }

 private:
  template <class Body>
  void for_dofs(const Body& body) {
    exec_.for_each("contact/krylov", island_.dof_end - island_.dof_begin,
                   FromBlock<Body>{body, island_.dof_begin});
  }

  /// out = -(A + J^T S J) x.
  void multiply(const Vector& x, Vector& out) {
    const BodiesView<double> bodies = {structure_.pairs(), view_of(system_.jacobian),
                                       view_of(system_.response), view_of(zero_offset_)};
    exec_.for_each("contact/krylov", island_.contact_count(),
                   FromContact<SpringForceBody>{
                       {bodies, view_of(std::as_const(tangents_)), x.data(), view_of(force_)},
                       island_.slot_begin});
    body_relax(exec_, island_.block_begin, island_.block_end,
               BodyDefectBody<double>{structure_.system(view_of(system_.system)),
                                      structure_.block_contacts(), view_of(system_.jacobian),
                                      view_of(zero_load_), view_of(std::as_const(force_)),
                                      view_of(x), view_of(out)});
  }

  /// out = approximately (A + J^T S J)^-1 g: inverse blocks plus the coarse space.
  void precondition(const Vector& g, Vector& out) {
    std::fill(out.begin() + island_.dof_begin, out.begin() + island_.dof_end, 0.0);
    body_relax(
        exec_, island_.block_begin, island_.block_end,
        BodyRelaxBody<double>{view_of(structure_.dof_start), view_of(structure_.inverse_start),
                              view_of(std::as_const(inverse_)), 1.0, view_of(g), view_of(out)});
    coarse_.add_correction(g.data() + island_.dof_begin, out.data() + island_.dof_begin);
  }

  void add_contacts_to_coarse() {
    coarse_.start_contacts();
    const PairView pairs = structure_.pairs();
    for (std::int64_t c = island_.slot_begin; c < island_.slot_end; ++c) {
      const std::int64_t last = pairs.pair_start[c + 1];
      for (std::int64_t p = pairs.pair_start[c]; p < last; ++p) {
        for (std::int64_t q = pairs.pair_start[c]; q < last; ++q) add_pair_to_coarse(c, p, q);
      }
    }
  }
  /// J_p^T S J_q of two blocks of 3 dofs.
  void add_pair_to_coarse(std::int64_t c, std::int64_t p, std::int64_t q) {
    const PairView pairs = structure_.pairs();
    const auto size_of_block = [&](std::int64_t pair) {
      const std::int32_t b = pairs.block[pair];
      return pairs.dof_start[b + 1] - pairs.dof_start[b];
    };
    if (size_of_block(p) != 3 || size_of_block(q) != 3) return;
    const double* left = system_.jacobian.data() + pairs.value_start[p];
    const double* right = system_.jacobian.data() + pairs.value_start[q];
    double entry[9];
    for (int k = 0; k < 3; ++k) {
      const double column[3] = {right[k], right[3 + k], right[6 + k]};
      double pull[3];
      tangents_[static_cast<std::size_t>(c)].apply(column, pull);
      for (int i = 0; i < 3; ++i) {
        entry[3 * i + k] = left[i] * pull[0] + left[3 + i] * pull[1] + left[6 + i] * pull[2];
      }
    }
    coarse_.add(pairs.block[p], pairs.block[q], entry);
  }

  Exec& exec_;
  const ContactStructure& structure_;
  const ContactSystem<double>& system_;
  const ContactIsland& island_;
  CoarseSpace& coarse_;
  Vector zero_load_, zero_offset_, force_;
  Vector inverse_;
  std::vector<ContactTangent<double>> tangents_;
  Vector direction_, product_, image_;
};

}  // namespace tetwarp
