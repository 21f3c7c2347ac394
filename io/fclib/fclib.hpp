/// @file fclib.hpp
/// The parts of an FCLIB file: paths, numbers, texts and matrices.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "io/h5/h5.hpp"

namespace tetwarp::fclib {

/// A vector of AdhesionState and its name in /adhesion.
struct AdhesionVector {
  const char* name;
  std::vector<double> AdhesionState::*member;
  std::int64_t per_contact = 1;
};
inline constexpr std::array<AdhesionVector, 9> adhesion_vectors = {{
    {"area", &AdhesionState::area},
    {"stiffness", &AdhesionState::stiffness},
    {"tangential_stiffness", &AdhesionState::tangential_stiffness},
    {"intensity", &AdhesionState::intensity},
    {"gap", &AdhesionState::gap, 3},
    {"energy", &AdhesionState::energy},
    {"viscosity", &AdhesionState::viscosity},
    {"bonding_rate", &AdhesionState::bonding_rate},
    {"saturation", &AdhesionState::saturation_pressure},
}};

/// The path inside the file of a member of ContactProblem, as ContactProblemError::field() names
/// it.
std::string path_of(const std::string& field, bool is_local);

/// A number of rows or entries that a file must have, and the reason, for messages.
struct Expected {
  std::int64_t count = 0;
  std::string reason;  ///< "three per contact"
};

// ---- numbers and texts: fclib_numbers.cpp ----

/// Number of elements of a dataset of numbers of any shape. Throws IoError beyond 2^31 - 1, the
/// largest number of rows that can be indexed.
std::int64_t element_count(const h5::Dataset& dataset);

/// The one number of a dataset of integers.
std::int64_t read_integer(const h5::Object& parent, const std::string& name);

/// All numbers of a dataset of integers.
std::vector<std::int64_t> read_integers(const h5::Object& parent, const std::string& name);

/// All numbers of a dataset. Throws IoError when one is not finite.
std::vector<double> read_reals(const h5::Object& parent, const std::string& name);

/// The same, throwing IoError before reading unless it has as many as expected.
std::vector<double> read_reals(const h5::Object& parent,
                               const std::string& name,
                               const Expected& expected);

/// A text; empty when the child is missing or holds no single text.
std::string read_text(const h5::Object& parent, const std::string& name);

/// Numbers as int32, FCLIB's integers. Throws IoError when one does not fit.
void write_integers(const h5::Object& parent,
                    const std::string& name,
                    const std::vector<std::int64_t>& values);
void write_reals(const h5::Object& parent,
                 const std::string& name,
                 const std::vector<double>& values);
void write_text(const h5::Object& parent, const std::string& name, const std::string& text);

// ---- matrices: fclib_matrix.cpp ----

/// A matrix as the file stores it, or its transpose.
enum class Orientation { plain, transposed };

/// Reads a matrix stored by columns, by rows or as triplets. `rows` and `columns` are those of the
/// stored matrix; they are checked before anything is allocated.
SparseMatrix read_matrix(const h5::Object& parent,
                         const std::string& name,
                         const Expected& rows,
                         const Expected& columns,
                         Orientation orientation);

/// Writes a matrix by rows or, transposed, its transpose by columns.
void write_matrix(const h5::Object& parent,
                  const std::string& name,
                  const SparseMatrix& matrix,
                  Orientation orientation);

// ---- rows beyond those of contacts: fclib_rows.cpp ----

/// Bilateral rows: FCLIB's G and b.
/// @param dofs  of the problem
BilateralRows read_bilateral(const h5::Object& root, const Expected& dofs);

/// What FCLIB has no place for: the groups /friction, /bilateral and /rolling. Those that are
/// missing leave the problem as it is.
void read_extensions(const h5::Object& file, ContactProblem& problem);

/// Impulses of these rows, from a solution or a guess; missing ones stay empty.
void read_row_guesses(const h5::Object& group, ContactProblem& problem);

/// Writes G and b.
void write_bilateral(const h5::Object& root, const h5::Object& vectors, const BilateralRows& rows);

/// Writes the groups that read_extensions() reads.
void write_extensions(const h5::Object& file, const ContactProblem& problem);

}  // namespace tetwarp::fclib
