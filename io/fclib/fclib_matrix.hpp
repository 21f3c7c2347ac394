/// @file fclib_matrix.hpp
/// Matrices of FCLIB files.
#pragma once
#include <string>

#include <tetwarp/contact_problem.hpp>

#include "io/fclib/fclib_numbers.hpp"
#include "io/h5/h5.hpp"

namespace tetwarp::fclib {

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

}  // namespace tetwarp::fclib
