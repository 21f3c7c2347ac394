/// @file contact_io.hpp
/// Contact problems and solutions as FCLIB files; checkpoints of simulations with tracked contacts.
/// All are HDF5 files; errors and temporary names as in io.hpp.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/contact.hpp>
#include <tetwarp/contact_analysis.hpp>
#include <tetwarp/contact_tracker.hpp>
#include <tetwarp/error.hpp>
#include <tetwarp/io_export.hpp>
#include <tetwarp/names.hpp>

namespace tetwarp {

/// The parts of an FCLIB file other than its problem.
struct ContactFileHeader {
  std::string title;
  std::string description;
  std::int64_t guesses = 0;   ///< number of starting points: /guesses/1 and so on
  bool has_solution = false;  ///< /solution/r exists, from any program, of any quality
  std::optional<std::string>
      status;                      ///< written by write_contact_solution(): name_of(ContactStatus)
  std::optional<double> residual;  ///< eta; written by write_contact_solution()
  /// Paths of what neither is in a ContactProblem nor here: names that FCLIB does not define, and
  /// what the form of the problem has no place for. A file with a solution, which is a copy, keeps
  /// it.
  std::vector<std::string> not_read = {};
};

TETWARP_IO_EXPORT ContactFileHeader read_contact_header(const std::string& path);

/// Impulses that the iterations start from.
enum class ContactStart {
  zero,   ///< `impulse_guess` stays empty
  stored  ///< the impulses of /solution or, when there are none or all are zero, of /guesses/1
};
template <>
TETWARP_IO_EXPORT std::span<const EnumName<ContactStart>> names_of();

/// Reads a contact problem in FCLIB's HDF5 format and checks it by check_problem(): /fclib_local
/// (W, q, mu) or /fclib_global (M, H, f, w, mu) with matrices by columns, by rows or as triplets,
/// and /adhesion and /blocks where the file has them. Numbers may be stored in any width, vectors
/// in any shape. Units are those of ContactProblem.
///
/// Not supported: two dimensions, equality constraints (G, or V and R), rolling friction.
/// One triangle of M suffices. In /adhesion `stiffness` needs `intensity`; others may be missing.
TETWARP_IO_EXPORT ContactProblem read_contact_problem(const std::string& path,
                                                      ContactStart start = ContactStart::zero);

/// Writes a problem that check_problem() accepts as an FCLIB file; matrices by rows, H by columns.
/// @returns bytes of the file
TETWARP_IO_EXPORT std::int64_t write_contact_problem(const std::string& path,
                                                     const ContactProblem& problem,
                                                     const std::string& title = {},
                                                     const std::string& description = {});

/// Writes a complete FCLIB file: a copy of the problem's file in which this solution replaces any
/// other, with the adhesion of the next step when it is given.
///
/// /solution/{r, u, v, residual_history} (no v in local form) has the attributes `converged` (1 or
/// 0), `status`, `residual` (eta), `fclib_error` and `method`; /adhesion_next holds `intensity` and
/// `gap`; with bilateral rows /solution/l is lambda, with rolling friction /solution/m its
/// impulses. With `modes`, /solution/contact_mode and contact_residual have one number per
/// contact. A solution of another size than the problem is an error.
/// @returns bytes of the file
TETWARP_IO_EXPORT std::int64_t write_contact_solution(const std::string& path,
                                                      const std::string& problem_path,
                                                      const ContactSolution& solution,
                                                      const AdhesionStep* adhesion_next = nullptr,
                                                      const ContactModes* modes = nullptr);

/// The state of a simulation with tracked contacts: restored from it, further steps have the same
/// bits as without a stop.
struct ContactCheckpoint {
  std::int64_t step = 0;               ///< steps done
  double time = 0;                     ///< [s]
  std::vector<BodyPose> poses;         ///< of all bodies, world
  std::vector<double> body_velocity;   ///< [dofs], as in ContactSolution [m/s, rad/s]
  std::vector<ContactRecord> records;  ///< ContactTracker::records()
};

/// Writes a checkpoint, under a temporary name until it is complete.
/// @throws IoError when the file cannot be written
/// @returns bytes of the file
TETWARP_IO_EXPORT std::int64_t write_contact_checkpoint(const std::string& path,
                                                        const ContactCheckpoint& checkpoint);

/// Reads a checkpoint.
/// @throws IoError when the file is not a checkpoint, is of a later version, or its arrays have
///                 sizes that contradict each other
TETWARP_IO_EXPORT ContactCheckpoint read_contact_checkpoint(const std::string& path);

}  // namespace tetwarp
