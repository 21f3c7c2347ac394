/// @file bind_contact.cpp
/// Contact problems, their solver and their files.
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <atomic>
#include <string>
#include <tetwarp/contact.hpp>
#include <tetwarp/contact_io.hpp>
#include <utility>
#include <vector>

#include "python/adhesion_fields.hpp"
#include "python/arrays.hpp"
#include "python/bind.hpp"
#include "python/choices.hpp"
#include "python/file_call.hpp"
#include "python/interruption.hpp"

namespace tetwarp::python {
namespace {
using InNumbers = In<double, nb::ndim<1>>;
using InIndices = In<std::int32_t, nb::ndim<1>>;
using InStarts = In<std::int64_t, nb::ndim<1>>;

/// Members of a problem and their names in Python, which are those of the C++ members.
struct NumbersOf {
  const char* name;
  std::vector<double> ContactProblem::*member;
};
constexpr NumbersOf problem_numbers[] = {{"load", &ContactProblem::load},
                                         {"velocity_offset", &ContactProblem::velocity_offset},
                                         {"free_velocity", &ContactProblem::free_velocity},
                                         {"friction", &ContactProblem::friction},
                                         {"second_friction", &ContactProblem::second_friction},
                                         {"impulse_guess", &ContactProblem::impulse_guess}};
struct MatrixOf {
  const char* name;
  SparseMatrix ContactProblem::*member;
};
constexpr MatrixOf problem_matrices[] = {{"system", &ContactProblem::system},
                                         {"jacobian", &ContactProblem::jacobian},
                                         {"delassus", &ContactProblem::delassus}};
std::vector<double> numbers_of(nb::handle array) {
  return vector_of(nb::cast<InNumbers>(array, false));
}

/// @param matrix  (data, indices, indptr, (rows, columns))
SparseMatrix matrix_of(const nb::tuple& matrix) {
  const auto shape = nb::cast<nb::tuple>(matrix[3]);
  return {nb::cast<std::int64_t>(shape[0]), nb::cast<std::int64_t>(shape[1]),
          vector_of(nb::cast<InStarts>(matrix[2], false)),
          vector_of(nb::cast<InIndices>(matrix[1], false)), numbers_of(matrix[0])};
}

AdhesionState adhesion_of(const nb::dict& all) {
  AdhesionState adhesion;
  adhesion.time_step = nb::cast<double>(all["time_step"]);
  for (const AdhesionField& field : adhesion_fields) {
    if (all.contains(field.name)) adhesion.*field.member = numbers_of(all[field.name]);
  }
  return adhesion;
}

std::vector<std::int32_t> indices_of(nb::handle array) {
  return vector_of(nb::cast<InIndices>(array, false));
}

/// Sets a vector from the array of its name, if there is one.
template <class Number, class Read>
void read_to(std::vector<Number>& numbers, const nb::dict& all, const char* name, Read read) {
  if (all.contains(name)) numbers = read(all[name]);
}

BilateralRows bilateral_of(const nb::dict& all) {
  BilateralRows rows;
  rows.jacobian = matrix_of(nb::cast<nb::tuple>(all["jacobian"]));
  read_to(rows.target, all, "target", numbers_of);
  read_to(rows.compliance, all, "compliance", numbers_of);
  read_to(rows.group_start, all, "group_start", indices_of);
  read_to(rows.impulse_guess, all, "impulse_guess", numbers_of);
  return rows;
}

RollingFriction rolling_of(const nb::dict& all) {
  RollingFriction entries;
  entries.jacobian = matrix_of(nb::cast<nb::tuple>(all["jacobian"]));
  read_to(entries.contact, all, "contact", indices_of);
  read_to(entries.rolling, all, "rolling", numbers_of);
  read_to(entries.torsion, all, "torsion", numbers_of);
  read_to(entries.impulse_guess, all, "impulse_guess", numbers_of);
  return entries;
}

/// @param all  arrays and matrices by the names of the members; what is missing stays empty
ContactProblem problem_of(const nb::dict& all) {
  ContactProblem problem;
  for (const MatrixOf& matrix : problem_matrices) {
    if (!all.contains(matrix.name)) continue;
    problem.*matrix.member = matrix_of(nb::cast<nb::tuple>(all[matrix.name]));
  }
  for (const NumbersOf& numbers : problem_numbers) {
    if (all.contains(numbers.name)) problem.*numbers.member = numbers_of(all[numbers.name]);
  }
  read_to(problem.block_start, all, "block_start", indices_of);
  const auto part = [&](const char* name) { return nb::cast<nb::dict>(all[name]); };
  if (all.contains("adhesion")) problem.adhesion = adhesion_of(part("adhesion"));
  if (all.contains("bilateral")) problem.bilateral = bilateral_of(part("bilateral"));
  if (all.contains("rolling")) problem.rolling = rolling_of(part("rolling"));
  return problem;
}

nb::tuple tuple_of(SparseMatrix matrix) {
  const nb::tuple shape = nb::make_tuple(matrix.rows, matrix.columns);
  return nb::make_tuple(array_of(std::move(matrix.value)), array_of(std::move(matrix.column)),
                        array_of(std::move(matrix.row_start)), shape);
}

/// The arrays that are not empty, by their names.
template <class Number>
void write_from(std::vector<Number>& numbers, nb::dict& all, const char* name) {
  if (!numbers.empty()) all[name] = array_of(std::move(numbers));
}

nb::dict dict_of(BilateralRows rows) {
  nb::dict all;
  all["jacobian"] = tuple_of(std::move(rows.jacobian));
  write_from(rows.target, all, "target");
  write_from(rows.compliance, all, "compliance");
  write_from(rows.group_start, all, "group_start");
  write_from(rows.impulse_guess, all, "impulse_guess");
  return all;
}

nb::dict dict_of(RollingFriction entries) {
  nb::dict all;
  all["jacobian"] = tuple_of(std::move(entries.jacobian));
  write_from(entries.contact, all, "contact");
  write_from(entries.rolling, all, "rolling");
  write_from(entries.torsion, all, "torsion");
  write_from(entries.impulse_guess, all, "impulse_guess");
  return all;
}

nb::dict dict_of(ContactProblem problem) {
  nb::dict all;
  for (const MatrixOf& matrix : problem_matrices) {
    if ((problem.*matrix.member).empty()) continue;
    all[matrix.name] = tuple_of(std::move(problem.*matrix.member));
  }
  for (const NumbersOf& numbers : problem_numbers) {
    if ((problem.*numbers.member).empty()) continue;
    all[numbers.name] = array_of(std::move(problem.*numbers.member));
  }
  if (!problem.block_start.empty()) all["block_start"] = array_of(std::move(problem.block_start));
  if (!problem.adhesion.empty()) all["adhesion"] = adhesion_dict(std::move(problem.adhesion));
  if (!problem.bilateral.empty()) all["bilateral"] = dict_of(std::move(problem.bilateral));
  if (!problem.rolling.empty()) all["rolling"] = dict_of(std::move(problem.rolling));
  return all;
}

ContactOptions options_of(const std::string& law,
                          const std::string& rule,
                          const std::string& method,
                          const std::string& measure,
                          double tolerance,
                          std::int64_t max_sweeps,
                          double recovery_speed,
                          double max_seconds,
                          const std::string& backend,
                          int device,
                          int threads) {
  ContactOptions options;
  options.law = choice<FrictionLaw>("law", law);
  options.rule = choice<AdhesionRule>("rule", rule);
  options.method = choice<ContactMethod>("method", method);
  options.measure = choice<ContactMeasure>("measure", measure);
  options.tolerance = tolerance;
  options.max_sweeps = max_sweeps;
  options.recovery_speed = recovery_speed;
  options.max_seconds = max_seconds;
  options.backend = choice<Backend>("backend", backend);
  options.device = device;
  options.threads = threads;
  return options;
}

/// Rows of three numbers per contact.
NumpyArray rows_of(std::vector<double> numbers) {
  const std::size_t contacts = numbers.size() / 3;
  return array_of<double>(std::move(numbers), {contacts, 3});
}

/// A solver, which keeps its buffers between problems.
class DictSolver {
 public:
  explicit DictSolver(const ContactOptions& options) : solver_(with_progress(options)) {}

  nb::tuple solve(const nb::dict& problem, nb::object progress) {
    const OneCall call(is_running_, "ContactSolver");
    const ContactProblem arrays = problem_of(problem);
    Interruption interruption(std::move(progress));
    interruption_ = &interruption;  // read within solve() only
    ContactSolution solution = interruption.run([&] { return solver_.solve(arrays); });
    interruption.throw_error();
    const std::string report = to_json(solution.report);
    return nb::make_tuple(rows_of(std::move(solution.impulse)),
                          rows_of(std::move(solution.velocity)),
                          array_of(std::move(solution.body_velocity)),
                          array_of(std::move(solution.bilateral_impulse)),
                          rows_of(std::move(solution.rolling_impulse)), report);
  }

 private:
  ContactOptions with_progress(ContactOptions options) {
    options.progress = [this](const ContactProgress& progress) {
      return interruption_->go_on(progress.seconds, progress.sweeps);
    };
    return options;
  }

  Interruption* interruption_ = nullptr;
  ContactSolver solver_;
  std::atomic<bool> is_running_ = false;
};
}  // namespace

void bind_contact(nb::module_& module) {
  nb::class_<DictSolver>(module, "ContactSolver")
      .def(
          "__init__",
          [](DictSolver* self, const std::string& law, const std::string& rule,
             const std::string& method, const std::string& measure, double tolerance,
             std::int64_t max_sweeps, double recovery_speed, double max_seconds,
             const std::string& backend, int device, int threads) {
            new (self)
                DictSolver(options_of(law, rule, method, measure, tolerance, max_sweeps,
                                      recovery_speed, max_seconds, backend, device, threads));
          },
          nb::kw_only(), nb::arg("law"), nb::arg("rule"), nb::arg("method"), nb::arg("measure"),
          nb::arg("tolerance"), nb::arg("max_sweeps"), nb::arg("recovery_speed"),
          nb::arg("max_seconds"), nb::arg("backend"), nb::arg("device"), nb::arg("threads"))
      .def("solve", &DictSolver::solve, nb::arg("problem"), nb::arg("progress").none());
  module.def(
      "read_contact_problem",
      [](const std::string& path) {
        return dict_of(file_call([&] {
          const ContactFileHeader header = read_contact_header(path);
          const bool has_guess = header.has_solution || header.guesses > 0;
          return read_contact_problem(path, has_guess ? ContactStart::stored : ContactStart::zero);
        }));
      },
      nb::arg("path"));
  module.def(
      "write_contact_problem",
      [](const std::string& path, const nb::dict& problem, const std::string& title,
         const std::string& description) {
        const ContactProblem arrays = problem_of(problem);
        file_call([&] { return write_contact_problem(path, arrays, title, description); });
      },
      nb::arg("path"), nb::arg("problem"), nb::arg("title"), nb::arg("description"));
}

}  // namespace tetwarp::python
