/// @file test_contact_stress_choice.cpp
/// The automatic choice beside every single method, by counted work, so that the comparison is the
/// same on every machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/newton/augmented_lagrangian.hpp"
#include "host/contact/newton/newton_system.hpp"
#include "host/contact/solve/method_choice.hpp"
#include "tests/support/contact/contact_methods.hpp"
#include "tests/support/contact/contact_scenes.hpp"

namespace tetwarp::test {
namespace {
constexpr double infinity = std::numeric_limits<double>::infinity();

struct Subject {
  std::string name;
  ContactProblem problem;  ///< of one island
};

std::vector<Subject> subjects() {
  const scenes::Glue glue{.stiffness = 1e7};
  ContactProblem linked = scenes::sphere_packing({.edge = 6});
  scenes::add_ball_joints(linked, 108, 0.05);
  return {
      {"stack of 10", scenes::box_stack({.boxes = 10})},
      {"stack of 20", scenes::box_stack({.boxes = 20})},
      {"stack of 6, masses 3^n", scenes::box_stack({.boxes = 6, .mass_ratio = 243})},
      {"stack of 30, masses to 1e4", scenes::box_stack({.boxes = 30, .mass_ratio = 1e4})},
      {"jam of 48", scenes::jam({})},
      {"jam of 48, glued", scenes::jam({.glue = glue})},
      {"jam of 150",
       scenes::jam({.seed = 3, .bodies = 30, .contacts = 150, .mass_ratio = 1e4, .friction = 0.5})},
      {"touching spheres, friction 0.3",
       scenes::sphere_packing({.edge = 4, .friction = 0.3, .gaps = 0})},
      {"touching spheres, friction 0.5",
       scenes::sphere_packing({.edge = 4, .friction = 0.5, .gaps = 0})},
      {"packing, friction 0.8", scenes::sphere_packing({.edge = 6, .friction = 0.8})},
      {"packing, glued", scenes::sphere_packing({.edge = 6, .glue = glue})},
      {"packing, joints", linked},
      {"lattice of 1664", scenes::boxed_lattice({})},
  };
}

/// Work of a solve in sweeps over all contacts; infinite if it has not converged.
double work_of(const ContactProblem& problem, const ContactOptions& options, double newton_step) {
  const ContactReport report = solve_contacts(problem, options).report;
  if (report.status != ContactStatus::converged) return infinity;
  double work = static_cast<double>(report.sweeps);
  if (report.newton_iterations > 0) {
    work += static_cast<double>(report.newton_iterations) * newton_step;
  }
  if (report.multiplier_steps > 0) {
    work += static_cast<double>(report.multiplier_steps) *
            sweeps_per_multiplier_step(problem.dof_count(), problem.contact_count());
  }
  return work;
}
}  // namespace

/// Methods that do not converge within eight times the sweeps of the automatic choice are not the
/// quickest and stop there.
TEST(ContactStress, AutomaticTakesAtMostHalfMoreThanTheBestMethod) {
  for (const auto& [name, problem] : subjects()) {
    const double newton_step =
        problem.bilateral.empty()
            ? sweeps_per_newton_step(newton_cost(problem, infinity), problem.contact_count())
            : infinity;
    for (const AdhesionRule rule : {AdhesionRule::parallel, AdhesionRule::restrictive}) {
      if (rule == AdhesionRule::restrictive && problem.adhesion.empty()) continue;
      for (const double tolerance : {1e-4, 1e-6}) {
        SCOPED_TRACE(testing::Message() << name << ", " << tolerance);
        if (!problem.bilateral.empty() && tolerance < 1e-4) continue;  // no single method converges
        ContactOptions options = {.rule = rule, .tolerance = tolerance, .max_newton = 400};
        const double own = work_of(problem, options, newton_step);
        EXPECT_LT(own, infinity);
        if (own == infinity) continue;
        options.max_sweeps = 8 * static_cast<std::int64_t>(own) + 100;
        double best = infinity;
        for (const ContactMethod method : methods) {
          if (method == ContactMethod::automatic) continue;
          options.method = method;
          best = std::min(best, work_of(problem, options, newton_step));
        }
        EXPECT_LE(own, 1.5 * best);
      }
    }
  }
}

}  // namespace tetwarp::test
