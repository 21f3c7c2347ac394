/// @file test_contact_reference_certified.cpp
/// Residuals and back end reference on problems with certified solutions. They are the .hdf5 files
/// of the folder that the environment variable TETWARP_CONTACT_DATA names, or that of the same name
/// given to the compiler.
#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>
#include <system_error>
#include <tetwarp/io.hpp>
#include <vector>

#include "host/contact/problem/matrix.hpp"
#include "host/reference/contact/contact.hpp"
#include "tests/support/contact/contact_data.hpp"
#include "tests/support/contact/contact_files.hpp"
#include "tests/support/contact/contact_samples.hpp"

namespace tetwarp {
namespace {
using samples::vector_of;

/// One solution of one file.
struct Certificate {
  std::string file;
  std::string group;
  ContactOptions options;
  bool is_velocity_unique = true;
};

std::vector<Certificate> certificates() {
  std::set<std::filesystem::path> files;
  std::error_code no_folder;
  for (const auto& entry :
       std::filesystem::directory_iterator(test::contact_data_folder(), no_folder)) {
    if (entry.path().extension() == ".hdf5") files.insert(entry.path());
  }
  std::vector<Certificate> all;
  for (const std::filesystem::path& file : files) {
    for (const FrictionLaw law : {FrictionLaw::cone, FrictionLaw::pyramid}) {
      for (const AdhesionRule rule : {AdhesionRule::parallel, AdhesionRule::restrictive}) {
        const std::string group = std::string("/certified/") +
                                  (law == FrictionLaw::cone ? "cone" : "pyramid") +
                                  (rule == AdhesionRule::parallel ? "_parallel" : "_restrictive");
        if (!test::holds(file, "/certified") || !test::holds(file, group)) continue;
        all.push_back({file,
                       group,
                       {.law = law, .rule = rule, .tolerance = 1e-11},
                       test::attribute_of(file, group, "v_unique") != 0});
      }
    }
  }
  return all;
}

class ReferenceCertified : public testing::Test {
 protected:
  void SetUp() override {
    if (certified.empty()) {
      GTEST_SKIP() << "no certified problems; set TETWARP_CONTACT_DATA to their folder";
    }
  }

  const std::vector<Certificate> certified = certificates();
};

TEST_F(ReferenceCertified, SolutionsHaveNoResidual) {
  for (const Certificate& certificate : certified) {
    SCOPED_TRACE(certificate.file + certificate.group);
    const std::vector<double> impulse =
        test::numbers_of(certificate.file, certificate.group + "/r");
    const std::vector<double> velocity =
        test::numbers_of(certificate.file, certificate.group + "/v");

    const ContactResidual residual =
        residual_of(read_contact_problem(certificate.file), impulse, velocity, certificate.options);

    // Certified in 80 bits to a few 1e-16; the rest is rounding in 64.
    EXPECT_LE(residual.eta, 1e-14);
    EXPECT_LE(residual.balance, 1e-14);
    EXPECT_LE(residual.fclib, 1e-13);
    EXPECT_LE(residual.penetration, 1e-13);
  }
}

TEST_F(ReferenceCertified, SmallProblemsAreSolvedToTheCertifiedVelocity) {
  // The reference takes too long on larger stacks and packings.
  constexpr std::int64_t max_contacts = 32;
  int compared = 0;
  for (const Certificate& certificate : certified) {
    SCOPED_TRACE(certificate.file + certificate.group);
    const ContactProblem problem = read_contact_problem(certificate.file);
    if (problem.contact_count() > max_contacts) continue;

    const ContactSolution solution = solve_contacts_reference(problem, certificate.options);

    EXPECT_TRUE(solution.converged()) << solution.report.residual.eta;
    if (!certificate.is_velocity_unique) continue;
    const Eigen::SparseMatrix<double> system = make_eigen(problem.system);
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(system);
    const Eigen::VectorXd certified =
        vector_of(test::numbers_of(certificate.file, certificate.group + "/v"));
    const auto energy = [&](const Eigen::VectorXd& v) { return v.dot(system * v); };
    EXPECT_LE(energy(vector_of(solution.body_velocity) - certified),
              1e-18 * energy(certified - factor.solve(vector_of(problem.load))));
    ++compared;
  }
  EXPECT_GT(compared, 0);
}
}  // namespace
}  // namespace tetwarp
