/// @file contact_samples.hpp
/// Contact problems made of dense matrices, by hand or from a seed.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <vector>

#include <tetwarp/contact_problem.hpp>

namespace tetwarp::samples {

/// Every entry that is not zero.
SparseMatrix sparse_of(const Eigen::MatrixXd& dense);

std::vector<double> list_of(const Eigen::VectorXd& values);

Eigen::VectorXd vector_of(const std::vector<double>& values);

/// Symmetric positive definite, eigenvalues from 1 to `condition`.
Eigen::MatrixXd random_spd(std::mt19937& random, Eigen::Index size, double condition);

Eigen::VectorXd random_vector(std::mt19937& random, Eigen::Index size);

/// Adhesion whose kappa are the given ones [kg], with stored tangential gaps up to about 1 m/s *
/// dt.
AdhesionState adhesion_of(std::mt19937& random, const std::vector<double>& kappa);

/// kappa from 1e-3 to 1e3 kg, a fifth of them 0.
std::vector<double> random_kappa(std::mt19937& random, std::int64_t contacts);

/// Local problem in which all contacts are coupled.
ContactProblem random_local(std::mt19937& random,
                            std::int64_t contacts,
                            double friction,
                            const std::vector<double>& kappa,
                            double condition = 30);

/// One contact with B the identity times 1 kg^-1, moving with the given velocity [m/s].
ContactProblem single_contact(const Eigen::Vector3d& velocity, double friction);

/// Adhesion of one contact with the same kappa [kg] along all axes and no stored gap.
AdhesionState bond(double kappa);

/// `bodies` of `dofs` dofs each, coupled to the next one with `coupling` of their own stiffness,
/// each with one contact with the ground and one with the next body.
ContactProblem random_global(
    std::mt19937& random, Eigen::Index bodies, Eigen::Index dofs, double coupling, double friction);

/// Of a symmetric matrix.
double smallest_eigenvalue(const Eigen::MatrixXd& matrix);

/// Solutions of a symmetric positive definite system, one per column.
Eigen::MatrixXd solve_spd(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right_sides);

}  // namespace tetwarp::samples
