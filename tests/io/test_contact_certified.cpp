/// @file test_contact_certified.cpp
/// Problems with known solutions: files certified elsewhere, and elastic blocks against the
/// reference.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <tetwarp/contact.hpp>
#include <tetwarp/io.hpp>
#include <vector>

#include "io/fclib/fclib_numbers.hpp"
#include "io/h5/h5_attribute.hpp"
#include "tests/support/contact/contact_data.hpp"
#include "tests/support/elastic_block.hpp"

namespace tetwarp::test {
namespace {
/// sqrt(x' A x).
double energy_norm(const SparseMatrix& a, const std::vector<double>& x) {
  double sum = 0;
  for (std::size_t row = 0; row < x.size(); ++row) {
    const auto end = static_cast<std::size_t>(a.row_start[row + 1]);
    for (auto e = static_cast<std::size_t>(a.row_start[row]); e < end; ++e) {
      sum += x[row] * a.value[e] * x[static_cast<std::size_t>(a.column[e])];
    }
  }
  return std::sqrt(std::max(sum, 0.0));
}

std::vector<double> minus(std::vector<double> a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return a;
}

/// Velocity without contacts.
std::vector<double> free_velocity(ContactProblem problem) {
  problem.jacobian = {0, problem.system.columns, {0}, {}, {}};
  problem.velocity_offset.clear();
  problem.friction.clear();
  problem.adhesion = {};
  problem.impulse_guess.clear();
  return solve_contacts(problem).body_velocity;
}

/// ||v - v*||_A / ||v* - v_free||_A
double velocity_error(const ContactProblem& problem,
                      const std::vector<double>& velocity,
                      const std::vector<double>& certified) {
  const double size = energy_norm(problem.system, minus(certified, free_velocity(problem)));
  return energy_norm(problem.system, minus(velocity, certified)) / size;
}

// ---- files ----

struct Variant {
  const char* name;
  FrictionLaw law;
  AdhesionRule rule;
};
constexpr Variant variants[] = {
    {"cone_parallel", FrictionLaw::cone, AdhesionRule::parallel},
    {"cone_restrictive", FrictionLaw::cone, AdhesionRule::restrictive},
    {"pyramid_parallel", FrictionLaw::pyramid, AdhesionRule::parallel},
    {"pyramid_restrictive", FrictionLaw::pyramid, AdhesionRule::restrictive}};

std::vector<std::filesystem::path> certified_files() {
  std::vector<std::filesystem::path> files;
  if (!std::filesystem::is_directory(contact_data_folder())) return files;
  for (const auto& entry : std::filesystem::directory_iterator(contact_data_folder())) {
    if (entry.path().extension() == ".hdf5") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Attribute `v_unique`, a byte that other programs write as an enumeration; absent: true.
bool is_unique(const h5::Object& certificate) {
  if (!h5::has_attribute(certificate, "v_unique")) return true;
  const h5::Handle attribute(H5Aopen(certificate.id(), "v_unique", H5P_DEFAULT), H5Aclose);
  const h5::Handle type(H5Aget_type(attribute.id()), H5Tclose);
  std::int8_t value = 0;
  EXPECT_EQ(H5Tget_size(type.id()), sizeof value);
  EXPECT_GE(H5Aread(attribute.id(), type.id(), &value), 0);
  return value != 0;
}

TEST(Certified, EveryFileIsSolvedToItsVelocities) {
  const std::vector<std::filesystem::path> files = certified_files();
  if (files.empty()) {
    GTEST_SKIP() << "no certified problems: set TETWARP_CONTACT_DATA to a folder of FCLIB files "
                    "with /certified groups";
  }
  for (const std::filesystem::path& path : files) {
    const ContactProblem problem = read_contact_problem(path.string());
    const h5::Object file = h5::open_file(path.string());
    for (const Variant& variant : variants) {
      const std::string group = std::string("certified/") + variant.name;
      if (!h5::has_child(file, "certified") ||
          !h5::has_child(h5::open_group(file, "certified"), variant.name)) {
        continue;
      }
      const std::string what = path.filename().string() + " " + variant.name;
      const ContactOptions options{
          .law = variant.law, .rule = variant.rule, .tolerance = 1e-9, .max_sweeps = 200000};

      const ContactSolution solution = solve_contacts(problem, options);

      EXPECT_TRUE(solution.converged()) << what << ": " << solution.report.status_reason;
      EXPECT_LE(solution.report.residual.eta, 1e-8) << what;
      const h5::Object certificate = h5::open_group(file, group);
      if (!is_unique(certificate)) continue;
      const std::vector<double> certified = fclib::read_reals(certificate, "v");
      EXPECT_LE(velocity_error(problem, solution.body_velocity, certified), 1e-6) << what;
    }
  }
}

// ---- elastic blocks ----

ContactOptions plain_sweeps() {
  return {.method = ContactMethod::gauss_seidel, .tolerance = 1e-10, .max_sweeps = 5000};
}

/// Sweeps work on the condensed contacts, so stiffness and time step do not slow them.
TEST(ElasticBlock, IsSolvedByPlainSweepsWhateverItsStiffness) {
  for (const double young : {1e4, 1e5, 1e6}) {
    const ContactProblem problem = make_elastic_problem({.young = young, .time_step = 5e-3});

    const ContactSolution solution = solve_contacts(problem, plain_sweeps());

    EXPECT_TRUE(solution.converged()) << young << ": " << solution.report.status_reason;
  }
}

/// Rows in traction and in compression at once, both laws and rules.
TEST(ElasticBlock, HasTheVelocitiesOfTheReference) {
  const ContactProblem problem = make_elastic_problem({});
  for (const Variant& variant : variants) {
    ContactOptions options{.law = variant.law, .rule = variant.rule, .tolerance = 1e-10};
    const ContactSolution solution = solve_contacts(problem, options);
    options.backend = Backend::reference;
    const ContactSolution reference = solve_contacts(problem, options);

    int pulled = 0;
    for (std::size_t row = 0; row < reference.impulse.size(); row += 3) {
      pulled += reference.impulse[row] < 0;
    }
    EXPECT_GT(pulled, 0);
    EXPECT_LT(pulled, problem.contact_count());
    EXPECT_LE(velocity_error(problem, solution.body_velocity, reference.body_velocity), 1e-7)
        << variant.name;
  }
}
}  // namespace
}  // namespace tetwarp::test
