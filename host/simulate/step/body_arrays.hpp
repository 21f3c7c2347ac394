/// @file body_arrays.hpp
/// The arrays of a Model and of its steps in memory of an executor, with the views that stages
/// read.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "host/simulate/model/model.hpp"
#include "host/simulate/step/stepper.hpp"
#include "host/simulate/step/system_pattern.hpp"
#include "kernels/body/block_assemble.hpp"
#include "kernels/body/row_load.hpp"
#include "kernels/body/tet_force.hpp"

namespace tetwarp {

template <class T>
std::int64_t count_of(const std::vector<T>& values) {
  return static_cast<std::int64_t>(values.size());
}
template <class T>
View<const double> numbers_of(const std::vector<T>& arrays) {
  // NOLINTNEXTLINE(bugprone-sizeof-expression): T may be double itself
  constexpr std::int64_t width = sizeof(T) / sizeof(double);
  return {reinterpret_cast<const double*>(arrays.data()), width * count_of(arrays)};
}

/// SystemPattern in memory of the executor.
template <class Exec>
class PatternArrays {
 public:
  template <class T>
  using Vector = typename Exec::template LargeVector<T>;

  PatternArrays(Exec& exec, const SystemPattern& pattern) {
    rows_.count = pattern.row_count;
    rows_.unknown_count = pattern.unknown_count;
    rows_.block_of = put(exec, pattern.block_of, block_of_);
    rows_.start = put(exec, pattern.start, start_);
    rows_.free_end = put(exec, pattern.free_end, free_end_);
    rows_.column = put(exec, pattern.column, column_);
    rows_.diagonal = put(exec, pattern.diagonal, diagonal_);
    rows_.pair = put(exec, pattern.pair, pair_);
    rows_.upper = put(exec, pattern.upper, upper_);
    rows_.scalar_start = put(exec, pattern.scalar_start, scalar_start_);
    rows_.tets = put(exec, pattern.tets, tets_);
    rows_.edges = put(exec, pattern.edges, edges_);
    rows_.springs = put(exec, pattern.springs, springs_);
  }
  const SystemRows& rows() const { return rows_; }

 private:
  struct Lists {
    Vector<std::int32_t> start;
    Vector<std::uint32_t> item;
  };
  struct Elements {
    Lists blocks, rows;
  };

  template <class T>
  static View<const T> put(Exec& exec, const std::vector<T>& host, Vector<T>& own) {
    exec.put(host.data(), count_of(host), own);
    return exec.view(own);
  }
  static ItemLists put(Exec& exec, const ItemArrays& host, Lists& own) {
    return {put(exec, host.start, own.start), put(exec, host.item, own.item)};
  }
  static ElementLists put(Exec& exec, const ElementArrays& host, Elements& own) {
    return {put(exec, host.blocks, own.blocks), put(exec, host.rows, own.rows)};
  }

  SystemRows rows_;
  Vector<std::int32_t> block_of_, start_, free_end_, column_, diagonal_, scalar_start_;
  Vector<std::uint8_t> pair_;
  Vector<UpperBlock> upper_;
  Elements tets_, edges_, springs_;
};

/// Constants of elements, masses and springs.
template <class Exec>
class ConstantArrays {
 public:
  template <class T>
  using Vector = typename Exec::template LargeVector<T>;

  ConstantArrays(Exec& exec, const Model& model) {
    put_tets(exec, model.tets);
    put_scalars(exec, model.scalar_blocks);
    edge_nodes = put(exec, reinterpret_cast<const std::int32_t*>(model.edges.nodes.data()),
                     2 * count_of(model.edges.nodes), edge_nodes_);
    edge_stiffness = put(exec, model.edges.stiffness, edge_stiffness_);
    edge_rest = put(exec, model.edges.rest_length, edge_rest_);
    edge_gamma = put(exec, model.edges.gamma, edge_gamma_);
    rigid.mass = put(exec, model.rigid.mass, rigid_mass_);
    rigid.alpha = put(exec, model.rigid.alpha, rigid_alpha_);
    moments = put(exec, numbers_of(model.rigid.inertia).data, 3 * count_of(model.rigid.inertia),
                  moments_);
    node_mass = put(exec, model.node_mass, node_mass_);
    std::vector<SpringConstants> packed;
    for (std::size_t s = 0; s < model.springs.a.size(); ++s)
      packed.push_back(spring(model.springs, s));
    springs = put(exec, packed, springs_);
  }

  TetConstants tets;
  ScalarEntries scalars;
  RigidConstants rigid;  ///< each step sets its inertia
  View<const double> moments, node_mass;
  View<const std::int32_t> edge_nodes;
  View<const double> edge_stiffness, edge_rest, edge_gamma;
  View<const SpringConstants> springs;

 private:
  template <class T>
  static View<const T> put(Exec& exec, const T* host, std::int64_t size, Vector<T>& own) {
    exec.put(host, size, own);
    return exec.view(own);
  }
  template <class T>
  static View<const T> put(Exec& exec, const std::vector<T>& host, Vector<T>& own) {
    return put(exec, host.data(), count_of(host), own);
  }

  void put_tets(Exec& exec, const ModelTets& model) {
    const std::size_t count = model.nodes.size();
    std::vector<std::int32_t> corner(4 * count);
    std::vector<double> gradient(9 * count), lambda(count), mu(count);
    for (std::size_t t = 0; t < count; ++t) {
      for (std::size_t a = 0; a < 4; ++a) corner[a * count + t] = model.nodes[t][a];
      for (std::size_t k = 0; k < 9; ++k) gradient[k * count + t] = model.gradient[t][k];
      lambda[t] = model.volume[t] * model.lambda[t];
      mu[t] = model.volume[t] * model.mu[t];
    }
    tets.corner = put(exec, corner, corner_);
    tets.gradient = put(exec, gradient, gradient_);
    tets.volume_lambda = put(exec, lambda, volume_lambda_);
    tets.volume_mu = put(exec, mu, volume_mu_);
    tets.gamma = put(exec, model.gamma, tet_gamma_);
    tets.count = count_of(model.nodes);
  }
  void put_scalars(Exec& exec, const ModelScalarBlocks& model) {
    std::vector<std::int32_t> column;
    for (const auto& nodes : model.nodes) column.push_back(nodes[1]);
    scalars.column = put(exec, column, column_);
    scalars.mass = put(exec, model.mass, mass_);
    scalars.mass_alpha = put(exec, model.mass_alpha, mass_alpha_);
    scalars.bend = put(exec, model.bend, bend_);
    scalars.bend_gamma = put(exec, model.bend_gamma, bend_gamma_);
  }
  static SpringEnd end_of(const ModelPoint& point) {
    SpringEnd end{};
    for (std::size_t k = 0; k < 4; ++k) {
      end.node[k] = point.rigid >= 0 ? -1 : point.node[k];
      end.weight[k] = point.weight[k];
    }
    end.rigid = point.rigid;
    for (std::size_t i = 0; i < 3; ++i) end.local[i] = point.local[i];
    return end;
  }
  static SpringConstants spring(const ModelSprings& model, std::size_t s) {
    SpringConstants own{};
    own.a = end_of(model.a[s]);
    own.b = end_of(model.b[s]);
    own.stiffness = model.stiffness[s];
    own.damping = model.damping[s];
    own.has_anchor = model.handle[s] >= 0;
    return own;
  }

  Vector<std::int32_t> corner_, column_, edge_nodes_;
  Vector<double> gradient_, volume_lambda_, volume_mu_, tet_gamma_;
  Vector<double> mass_, mass_alpha_, bend_, bend_gamma_;
  Vector<double> edge_stiffness_, edge_rest_, edge_gamma_;
  Vector<double> rigid_mass_, rigid_alpha_, moments_, node_mass_;
  Vector<SpringConstants> springs_;
};

/// State and intermediate results of steps.
template <class Exec>
struct StepArrays {
  template <class T>
  using Vector = typename Exec::template LargeVector<T>;

  Vector<double> position, center, rotation, velocity, angular_momentum;  ///< of ModelState
  Vector<double> previous;                                                ///< NodeMovedOp
  Vector<double>
      fraction;  ///< [nodes, then rigid bodies] part of the step that each moves; empty: all
  typename Exec::template Input<double> prescribed, force, guess, anchor,
      anchor_velocity;  ///< StepInput
  typename Exec::template Input<std::uint8_t> is_active, is_asleep;
  Vector<std::uint8_t> has_moved, tet_has_turned, tet_is_skipped, edge_has_turned, block_is_skipped;
  Vector<TetTurned> turned;
  Vector<TetForce> tet_force;
  Vector<EdgePull> edge_pull;
  Vector<SpringPull> spring_pull;
  Vector<double> inertia;
  Vector<double> values, load, x, support;

  StepArrays(Exec& exec, const Model& model, const SystemRows& rows) {
    const std::int64_t nodes = model.node_count, rigid = model.rigid_count;
    exec.make_zeros(support, 3 * model.block_count());
    exec.make_zeros(has_moved, nodes);
    const std::int64_t tets = count_of(model.tets.nodes);
    exec.make_zeros(tet_has_turned, tets);
    exec.make_zeros(tet_is_skipped, tets);
    std::vector<TetTurned> start(model.tets.nodes.size());
    for (std::size_t t = 0; t < start.size(); ++t) {
      start[t].volume_lambda = model.tets.volume[t] * model.tets.lambda[t];
      start[t].volume_mu = model.tets.volume[t] * model.tets.mu[t];
      start[t].gamma = model.tets.gamma[t];
    }
    exec.put(start.data(), tets, turned);
    exec.make_zeros(tet_force, tets);
    exec.make_zeros(edge_pull, count_of(model.edges.nodes));
    exec.make_zeros(edge_has_turned, count_of(model.edges.nodes));
    exec.make_zeros(spring_pull, count_of(model.springs.a));
    exec.make_zeros(inertia, 9 * rigid);
    exec.make_zeros(block_is_skipped, rows.upper.size);
    exec.make_zeros(values, 9 * rows.column.size + 1);  // vectors read one number beyond a block
    exec.make_zeros(load, 3 * std::int64_t{rows.count});
    exec.make_zeros(x, 3 * std::int64_t{rows.count});
  }
};

}  // namespace tetwarp
