/// @file energy.cpp
/// energy_balance().
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <stdexcept>
#include <string>
#include <tetwarp/contact_analysis.hpp>
#include <vector>

#include "host/base/vector_view.hpp"
#include "host/contact/problem/matrix.hpp"
#include "host/contact/problem/measure.hpp"
#include "host/contact/problem/spring_offset.hpp"
#include "host/contact/problem/system_factor.hpp"

namespace tetwarp {
namespace {
using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

VectorXd make_vector(std::span<const double> values, std::int64_t expected, const char* name) {
  if (std::ssize(values) != expected) {
    throw std::invalid_argument(std::string(name) + ": " + std::to_string(values.size()) +
                                " entries, expected " + std::to_string(expected));
  }
  return VectorXd::Map(values.data(), static_cast<Index>(expected));
}

VectorXd product(const SparseMatrix& matrix, const VectorXd& x) {
  return matrix.rows == 0 ? VectorXd(0) : VectorXd(make_eigen(matrix) * x);
}

/// Adds the work of one contact.
/// @param offset   w
/// @param stretch  o_n of springs whose normal gap is not dt w_n, and o_t
void add_contact(const MeasuredContact& contact,
                 const Vector3d& impulse,
                 const Vector3d& velocity,
                 const Vector3d& offset,
                 const Vector3d& stretch,
                 EnergyBalance& energy) {
  const Vector3d end = velocity + stretch;  // gaps over dt at the end of the step
  Vector3d start = stretch;
  start(0) += offset(0);
  const Vector3d nu = impulse + contact.stiffness.cwiseProduct(end);
  const Vector3d motion = velocity - offset;  // of the bodies
  const Vector3d pull = contact.stiffness.cwiseProduct(end);
  energy.offset_work +=
      nu(0) * motion(0) - nu.tail<2>().dot(offset.tail<2>()) + pull.tail<2>().dot(offset.tail<2>());
  energy.friction_loss -= nu.tail<2>().dot(velocity.tail<2>());
  energy.adhesion_before += start.dot(contact.stiffness.cwiseProduct(start)) / 2;
  energy.adhesion_after += end.dot(pull) / 2;
  energy.adhesion_loss += (end - start).dot(contact.stiffness.cwiseProduct(end - start)) / 2;
}

void add_contacts(const ContactProblem& problem,
                  const ContactSolution& solution,
                  const VectorXd& v,
                  EnergyBalance& energy) {
  const std::int64_t rows = 3 * problem.contact_count();
  const VectorXd r = make_vector(solution.impulse, rows, "impulse");
  const VectorXd motion = product(problem.jacobian, v);
  const std::vector<MeasuredContact> contacts = measured_contacts(problem);
  const std::vector<double> normal = normal_offsets(problem);
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const auto row = 3 * static_cast<Index>(c);
    const Vector3d w = Vector3d::Map(problem.velocity_offset.data() + row);
    Vector3d stretch = contacts[c].offset;
    if (!normal.empty()) stretch(0) += normal[c];
    add_contact(contacts[c], r.segment<3>(row), motion.segment<3>(row) + w, w, stretch, energy);
  }
}

void add_rows(const ContactProblem& problem,
              const ContactSolution& solution,
              const VectorXd& v,
              EnergyBalance& energy) {
  const BilateralRows& rows = problem.bilateral;
  const VectorXd lambda =
      make_vector(solution.bilateral_impulse, rows.row_count(), "bilateral_impulse");
  for (std::size_t row = 0; row < rows.compliance.size(); ++row) {
    const double impulse = lambda(static_cast<Index>(row));
    energy.bilateral_loss += rows.compliance[row] * impulse * impulse;
  }
  energy.bilateral_work = lambda.dot(product(rows.jacobian, v)) + energy.bilateral_loss;
  const VectorXd m =
      make_vector(solution.rolling_impulse, 3 * problem.rolling.count(), "rolling_impulse");
  energy.rolling_loss = -m.dot(product(problem.rolling.jacobian, v));
}
}  // namespace

EnergyBalance energy_balance(const ContactProblem& problem,
                             const ContactSolution& solution,
                             std::span<const double> start_velocity) {
  check_problem(problem);
  if (problem.system.empty()) {
    throw std::invalid_argument(
        "problem: in local form, which has no masses; give the global form");
  }
  const Eigen::SparseMatrix<double> system = make_eigen(problem.system);
  SystemFactor factor;
  factor.factorize(system);
  const VectorXd v = make_vector(solution.body_velocity, problem.dof_count(), "body_velocity");
  const VectorXd load = make_vector(problem.load, problem.dof_count(), "load");
  const VectorXd free = factor.solve(load);
  EnergyBalance energy;
  energy.free = free.dot(load) / 2;
  energy.after = v.dot(system * v) / 2;
  const VectorXd change = v - free;
  energy.impact_loss = change.dot(system * change) / 2;
  add_contacts(problem, solution, v, energy);
  add_rows(problem, solution, v, energy);
  if (!start_velocity.empty()) {
    const VectorXd start = make_vector(start_velocity, problem.dof_count(), "start_velocity");
    energy.before = start.dot(system * start) / 2;
    energy.load_work = energy.free - energy.before;
  }
  const double gain = energy.offset_work + energy.bilateral_work;
  const double loss = energy.friction_loss + energy.rolling_loss + energy.impact_loss +
                      energy.bilateral_loss + energy.adhesion_loss;
  energy.error =
      energy.after - energy.free - gain + loss + (energy.adhesion_after - energy.adhesion_before);
  return energy;
}

}  // namespace tetwarp
