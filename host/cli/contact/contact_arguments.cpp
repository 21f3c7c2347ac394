/// @file contact_arguments.cpp
/// The options of tetwarp contact.
#include "host/cli/contact/contact_arguments.hpp"

#include <cstdint>
#include <limits>
#include <vector>

#include "host/cli/common/declare.hpp"

namespace tetwarp::cli {
namespace {
void declare_model(CLI::App& app, ContactArguments& arguments) {
  ContactOptions& options = arguments.options;
  app.add_option("PROBLEM", arguments.problem,
                 "FCLIB file, local or global, with or without "
                 "adhesion, bilateral rows and rolling friction")
      ->required()
      ->type_name("");
  app.add_option("-o,--output", arguments.output,
                 "file to write: the problem with its solution, also when it did not converge")
      ->required()
      ->type_name("SOLUTION");
  add_choice(app, "--law", options.law, choices_of<FrictionLaw>(), "friction law [cone]");
  add_choice(app, "--rule", options.rule, choices_of<AdhesionRule>(),
             "friction and adhesive spring add up, or the larger of both acts [parallel]");
  app.add_option("--recovery-speed", options.recovery_speed,
                 "maximum speed at which penetration is removed, in m/s [no limit]")
      ->check(above_zero())
      ->type_name("V");
  app.add_flag("--evolve", arguments.evolve,
               "also write the adhesion of the next step, /adhesion_next");
}

void declare_solver(CLI::App& app, ContactArguments& arguments) {
  ContactOptions& options = arguments.options;
  app.add_option("--tolerance", options.tolerance, "residual to reach [1e-6]")
      ->check(above_zero())
      ->type_name("E");
  add_choice(app, "--measure", options.measure, choices_of<ContactMeasure>(),
             "what the tolerance bounds: energy-weighted residual or FCLIB's error [eta]");
  app.add_option("--max-sweeps", options.max_sweeps,
                 "maximum number of passes over all contacts [100000]")
      ->check(at_least(1, std::numeric_limits<std::int64_t>::max()))
      ->type_name("N");
  app.add_option("--max-seconds", options.max_seconds,
                 "wall time after which the best iterate is written, in seconds [no limit]")
      ->check(above_zero())
      ->type_name("T");
  app.add_option("--max-newton", options.max_newton, "maximum number of Newton steps [no limit]")
      ->check(at_least(0))
      ->type_name("N");
  app.add_option("--memory", options.max_memory,
                 "memory limit of a factorization, e.g. 4G [20 times the problem, at least 256M]")
      ->transform(CLI::AsSizeValue(false))
      ->type_name("LIMIT");
  add_choice(app, "--solver", options.method, choices_of<ContactMethod>(),
             "solution method [auto]");
  add_choice(app, "--coupling", options.expert.coupling, choices_of<ContactCoupling>(),
             "bodies that A couples: condense them onto their contacts, or iterate [auto]");
  app.add_option("--relaxation", options.expert.relaxation,
                 "factor of the outer iteration, above 0 and below 2 [0.5]")
      ->check(above_zero())
      ->type_name("W");
  app.add_option("--inner", options.expert.inner_sweeps, "sweeps per outer iteration [5]")
      ->check(at_least(1))
      ->type_name("N");
  app.add_flag_callback(
      "--warm-start", [&arguments] { arguments.start = ContactStart::stored; },
      "start from the impulses of the file: its solution, else its first guess");
}

void declare_skips(CLI::App& app, ContactSkipOptions& skip) {
  using Switches = std::vector<bool ContactSkipOptions::*>;
  using Skip = ContactSkipOptions;
  const Choices<Switches> skips{
      {"frictionless-rows", {&Skip::frictionless_rows}},
      {"debonded-springs", {&Skip::debonded_springs}},
      {"contactless-bodies", {&Skip::contactless_bodies}},
      {"converged-islands", {&Skip::converged_islands}},
      {"frozen-contacts", {&Skip::frozen_contacts}},
      {"constant-systems", {&Skip::constant_systems}},
      {"all",
       {&Skip::frictionless_rows, &Skip::debonded_springs, &Skip::contactless_bodies,
        &Skip::converged_islands, &Skip::frozen_contacts, &Skip::constant_systems}}};
  add_word_list(
      app, "--no-skip", skips,
      [&skip](const Switches& members) {
        for (bool Skip::*member : members) skip.*member = false;
      },
      "disable optimizations; results change by no more than the tolerance");
}

void declare_running(CLI::App& app, ContactArguments& arguments) {
  ContactOptions& options = arguments.options;
  add_choice(app, "--backend", options.backend, choices_of<Backend>(), "where to compute [auto]");
  add_choice(app, "--precision", options.precision, choices_of<ContactPrecision>(),
             "floating-point format of the iterations [double]");
  add_device(app, options.device);
  add_threads(app, options.threads, "threads of the cpu back end, 0 for all cores [0]");
  declare_skips(app, options.expert.skip);
  app.add_option("--report", arguments.report, "write residuals, counts and timings as JSON")
      ->type_name("FILE");
  app.add_flag("--modes", arguments.modes,
               "also write mode and residual of each contact, /solution/contact_mode");
  app.add_flag("--energy", arguments.energy, "add the balance of energy to the report");
  add_quiet(app, arguments.quiet);
}
}  // namespace

void declare_contact_options(CLI::App& app, ContactArguments& arguments) {
  declare_model(app, arguments);
  declare_solver(app, arguments);
  declare_running(app, arguments);
}

}  // namespace tetwarp::cli
