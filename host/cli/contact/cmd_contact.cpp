/// @file cmd_contact.cpp
/// The subcommand contact.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <tetwarp/contact.hpp>
#include <tetwarp/contact_analysis.hpp>
#include <tetwarp/io.hpp>

#include "host/base/stopwatch.hpp"
#include "host/cli/common/commands.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/common/json_text.hpp"
#include "host/cli/contact/contact_arguments.hpp"
#include "io/files/finished_file.hpp"

namespace tetwarp::cli {
namespace {
constexpr int not_converged_exit_code = 3;
constexpr int no_solution_exit_code = 4;

struct FileSeconds {
  double read = 0;
  double write = 0;
};

void check_files(const ContactArguments& arguments) {
  check_kind(arguments.problem, FileKind::contact_problem,
             "usage: tetwarp contact PROBLEM -o SOLUTION");
  check_output_file(arguments.output, {arguments.problem});
  if (!arguments.report.empty()) {
    check_output_file(arguments.report, {arguments.problem, arguments.output});
  }
}

ContactProblem read_problem(const ContactArguments& arguments) {
  ContactProblem problem = read_contact_problem(arguments.problem, arguments.start);
  if (problem.is_local() && std::isfinite(arguments.options.recovery_speed)) {
    throw IoError(arguments.problem, "/fclib_local",
                  "has no offsets w, which --recovery-speed limits; write the problem in global "
                  "form, or leave the option out");
  }
  if (problem.is_local() && arguments.energy) {
    throw IoError(arguments.problem, "/fclib_local",
                  "has no masses, which --energy needs; write the problem in global form, or leave "
                  "the option out");
  }
  if (arguments.evolve && problem.adhesion.empty()) {
    throw IoError(arguments.problem, "/adhesion", "is missing, but --evolve needs it");
  }
  return problem;
}

/// Adds the name of the file to errors that only a factorization finds, e.g. a singular matrix.
ContactSolution solve(ContactSolver& solver,
                      const ContactProblem& problem,
                      const ContactArguments& arguments) {
  try {
    return solver.solve(problem);
  } catch (const ContactProblemError& error) {
    throw IoError(arguments.problem, "", error.what());
  }
}

nlohmann::ordered_json json_of(const EnergyBalance& energy) {
  return {{"free", energy.free},
          {"after", energy.after},
          {"offset_work", energy.offset_work},
          {"bilateral_work", energy.bilateral_work},
          {"friction_loss", energy.friction_loss},
          {"rolling_loss", energy.rolling_loss},
          {"impact_loss", energy.impact_loss},
          {"bilateral_loss", energy.bilateral_loss},
          {"adhesion_before", energy.adhesion_before},
          {"adhesion_after", energy.adhesion_after},
          {"adhesion_loss", energy.adhesion_loss},
          {"error", energy.error}};
}

void write_report(const std::string& path,
                  const ContactReport& report,
                  const std::optional<EnergyBalance>& energy,
                  const FileSeconds& seconds) {
  auto json = nlohmann::ordered_json::parse(to_json(report));
  if (energy) json["energy"] = json_of(*energy);
  json["timings"]["read"] = seconds.read;
  json["timings"]["write"] = seconds.write;
  json["timings"]["total"] = seconds.read + report.total_seconds + seconds.write;
  write_finished_file(path, json_text(json, 2) + "\n");
}

/// "residual 1.2e-07 after 40 sweeps".
std::string progress_of(const ContactReport& report, ContactMeasure measure) {
  const ContactResidual& residual = report.residual;
  const bool is_eta = measure == ContactMeasure::eta;
  return fmt::format("{} {:.2g} after {} sweeps", is_eta ? "residual" : "FCLIB error",
                     is_eta ? residual.eta : residual.fclib, report.sweeps);
}

void print_summary(const ContactArguments& arguments, const ContactReport& report) {
  fmt::print("{}, {}\n", name_of(report.backend), report.method);
  fmt::print("{} contact{}, {}, {}, {:.3g} s: {}\n", report.contacts,
             report.contacts == 1 ? "" : "s", name_of(report.status),
             progress_of(report, arguments.options.measure), report.total_seconds,
             arguments.output);
}

/// Prints a line on standard error unless the solve converged. @returns the exit code
int report_failure(const ContactArguments& arguments, const ContactReport& report) {
  if (report.status == ContactStatus::converged) return 0;
  const bool has_no_solution =
      report.status == ContactStatus::infeasible || report.status == ContactStatus::unbounded;
  const std::string reason = report.status_reason.empty() ? "" : " (" + report.status_reason + ")";
  const std::string line =
      fmt::format("{}: {}: {}, tolerance {:g}{}; the best iterate is in {}", arguments.problem,
                  name_of(report.status), progress_of(report, arguments.options.measure),
                  arguments.options.tolerance, reason, arguments.output);
  fmt::print(stderr, "tetwarp: {}\n", one_line(line));
  return has_no_solution ? no_solution_exit_code : not_converged_exit_code;
}

int run_contact(const ContactArguments& arguments) {
  check_files(arguments);
  FileSeconds seconds;
  const Stopwatch reading;
  const ContactProblem problem = read_problem(arguments);
  seconds.read = reading.seconds();
  ContactSolver solver(arguments.options);
  const ContactSolution solution = solve(solver, problem, arguments);
  const Stopwatch writing;
  std::optional<AdhesionStep> next;
  if (arguments.evolve) next = solver.evolve(problem, solution);
  std::optional<ContactModes> modes;
  if (arguments.modes) modes = contact_modes(problem, solution, arguments.options);
  std::optional<EnergyBalance> energy;
  if (arguments.energy) energy = energy_balance(problem, solution);
  write_contact_solution(arguments.output, arguments.problem, solution, next ? &*next : nullptr,
                         modes ? &*modes : nullptr);
  seconds.write = writing.seconds();
  if (!arguments.report.empty()) write_report(arguments.report, solution.report, energy, seconds);
  if (!arguments.quiet) print_summary(arguments, solution.report);
  return report_failure(arguments, solution.report);
}
}  // namespace

void add_contact_command(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<ContactArguments>();
  CLI::App* command = add_subcommand(
      app, "contact", "Solve one step of adhesive frictional contact",
      "PROBLEM -o SOLUTION [options]",
      "  tetwarp contact stack.hdf5 -o solved.hdf5\n"
      "  tetwarp contact stack.hdf5 -o solved.hdf5 --measure fclib --tolerance 1e-8 "
      "--report report.json\n"
      "  tetwarp contact glued.hdf5 -o next.hdf5 --rule restrictive --evolve\n"
      "Exit status: 0 converged; 3 not converged, the best iterate is written and marked; "
      "4 infeasible or unbounded, likewise; 2 bad usage; 1 any other failure\n");
  declare_contact_options(*command, *arguments);
  command->callback([arguments, command, &run] {
    check_device(*command, arguments->options.backend);
    if (arguments->energy && arguments->report.empty()) {
      throw CLI::ValidationError("--energy", "needs --report, which it adds to");
    }
    if (arguments->options.expert.relaxation >= 2) {
      throw CLI::ValidationError("--relaxation", "expected a number below 2");
    }
    run = [arguments] { return run_contact(*arguments); };
  });
}

}  // namespace tetwarp::cli
